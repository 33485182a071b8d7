// The calls to live sessions, one function each.

import { client, taken } from "../api/client";
import type { Schemas } from "../api/types";

export type Session = Schemas["SessionInfo"];
export type SessionEvent = Schemas["SessionEvent"];
export type Picture = Schemas["SessionPicture"];
export type LiveTrack = Schemas["LiveTrack"];

const path = (id: string) => ({ params: { path: { id } } });
const WAIT_S = 20;

export const listSessions = (query: { limit: number; cursor?: string }) =>
  taken(client.GET("/v1/sessions", { params: { query } }));
export const getSession = (id: string): Promise<Session> =>
  taken(client.GET("/v1/sessions/{id}", path(id)));
export const closeSession = (id: string): Promise<Session> =>
  taken(client.POST("/v1/sessions/{id}/close", path(id)));
export const pauseSession = (id: string): Promise<Session> =>
  taken(client.POST("/v1/sessions/{id}/pause", path(id)));
export const resumeSession = (id: string): Promise<Session> =>
  taken(client.POST("/v1/sessions/{id}/resume", path(id)));

/** What is believed, at once; or, after a number, once there is more. */
export function getPicture(
  id: string,
  after: number | undefined,
  signal: AbortSignal,
): Promise<Picture> {
  const query = after === undefined ? {} : { after_scan: after, wait: WAIT_S };
  return taken(
    client.GET("/v1/sessions/{id}/picture", { params: { path: { id }, query }, signal }),
  );
}

/** At most 500 events after a number. */
export const getEvents = (id: string, after: number) =>
  taken(client.GET("/v1/sessions/{id}/history", { params: { path: { id }, query: { after } } }));

export async function endTrack(id: string, name: string): Promise<void> {
  const params = { path: { id, name } };
  const { error, response } = await client.DELETE("/v1/sessions/{id}/tracks/{name}", { params });
  if (!response.ok) await taken(Promise.resolve({ error, response }));
}
