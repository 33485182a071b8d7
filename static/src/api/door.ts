// Signing in and out: the key goes into a cookie.

import { client, taken } from "./client";

/** Of an answer without a body. */
async function done(call: Promise<{ error?: unknown; response: Response }>): Promise<void> {
  const answer = await call;
  if (!answer.response.ok) await taken(Promise.resolve(answer));
}

export const logIn = (key: string): Promise<void> =>
  done(client.POST("/v1/login", { body: { key } }));
export const logOut = (): Promise<void> => done(client.POST("/v1/logout"));
