// A service for one file of tests: what another file makes, or how busy it keeps its service, is not
// seen here, and so files can be run beside each other.

import { spawn } from "node:child_process";
import { mkdtempSync, openSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";

const BIN = process.env.TRACKLOOM_BIN;
const SCRATCH = process.env.TRACKLOOM_SCRATCH ?? tmpdir();

/** An empty folder for the data of a service, which goes when the tests of this file end. */
export function dataFolder() {
  const data = mkdtempSync(join(SCRATCH, "data-"));
  process.on("exit", () => rmSync(data, { recursive: true, force: true }));
  return data;
}

/** Starts the service on a folder and waits until it listens. It ends with this process. */
export async function startService(data, port = 0, env = {}) {
  const log = openSync(join(SCRATCH, `${basename(process.argv[1])}.log`), "a");
  const child = spawn(BIN, ["serve", "--listen", `127.0.0.1:${port}`, "--data", data], {
    stdio: ["ignore", "pipe", log],
    env: { ...process.env, ...env },
  });
  const kill = () => child.kill();
  process.on("exit", kill);
  const gone = new Promise((take) => child.once("exit", take));
  const base = await new Promise((take, fail) => {
    child.stdout.on("data", (text) => {
      const address = /listening on (\S+)/.exec(text)?.[1];
      if (address) take(address);
    });
    child.once("exit", (code) => fail(new Error(`the service ended with ${code}`)));
  });
  child.unref();
  child.stdout.unref();
  return {
    base,
    stop: async () => {
      child.ref();
      kill();
      await gone;
      process.off("exit", kill);
    },
  };
}

for (const signal of ["SIGINT", "SIGTERM"]) process.once(signal, () => process.exit(1));

/** Where the service of this file is: the one that is named, else its own. */
export async function serviceAddress() {
  return process.env.TRACKLOOM_URL ?? (await startService(dataFolder())).base;
}
