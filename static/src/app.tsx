// The frame of every page, and which view the address asks for.

import type { JSX, TargetedEvent } from "preact";
import { useEffect } from "preact/hooks";
import { Empty, Link } from "./components/basics";
import { later } from "./components/later";
import { isShut, isSignedIn, noteSignedIn } from "./state/door";
import { chooseTheme, type ThemeChoice, themeChoice } from "./state/theme";
import { pageHref, param } from "./state/url";
import { JobList } from "./views/job-list";
import { JobPage } from "./views/job-page";

const TITLES: Record<string, string> = {
  jobs: "Jobs",
  new: "New job",
  job: "Job",
  compare: "Compare",
  datasets: "Data sets",
  dataset: "Data set",
  sessions: "Sessions",
  session: "Session",
};

// What few visits look at comes when it is looked at.
const Datasets = later("data sets", async () => (await import("./views/datasets")).Datasets);
const DatasetPage = later(
  "the data set",
  async () => (await import("./views/dataset-page")).DatasetPage,
);
const Sessions = later("sessions", async () => (await import("./views/sessions")).Sessions);
const SessionPage = later(
  "the session",
  async () => (await import("./views/session-page")).SessionPage,
);
const NewJob = later("the form", async () => (await import("./views/new-job")).NewJob);
const Compare = later("the comparison", async () => (await import("./views/compare")).Compare);

const Login = later("the way in", async () => (await import("./views/login")).Login);

function view(name: string): JSX.Element {
  if (name === "jobs") return <JobList />;
  if (name === "new") return <NewJob />;
  if (name === "job") return <JobPage key={param("job") ?? ""} id={param("job") ?? ""} />;
  if (name === "compare") return <Compare />;
  if (name === "datasets") return <Datasets />;
  if (name === "dataset")
    return <DatasetPage key={param("dataset") ?? ""} id={param("dataset") ?? ""} />;
  if (name === "sessions") return <Sessions />;
  if (name === "session")
    return <SessionPage key={param("session") ?? ""} id={param("session") ?? ""} />;
  return (
    <Empty title="There is no such page.">
      <Link href={pageHref({})}>Go to the jobs</Link>
    </Empty>
  );
}

function ThemeSwitch(): JSX.Element {
  const change = (event: TargetedEvent<HTMLSelectElement>) =>
    chooseTheme(event.currentTarget.value as ThemeChoice);
  return (
    <label class="theme-switch">
      <span class="visually-hidden">Theme</span>
      <select value={themeChoice.value} onChange={change}>
        <option value="system">System theme</option>
        <option value="light">Light</option>
        <option value="dark">Dark</option>
      </select>
    </label>
  );
}

function SignOut(): JSX.Element {
  const leave = async () => {
    const { logOut } = await import("./api/door");
    await logOut();
    noteSignedIn(false);
  };
  return (
    <button type="button" onClick={() => void leave()}>
      Sign out
    </button>
  );
}

/** `/` goes to the filter of the page, as in many tools. */
function focusFilter(event: KeyboardEvent): void {
  const target = event.target as HTMLElement;
  if (event.key !== "/" || target.closest("input, textarea, select")) return;
  const filter = document.querySelector<HTMLInputElement>("[data-filter]");
  if (!filter) return;
  event.preventDefault();
  filter.focus();
}

export function App(): JSX.Element {
  const name = param("view") ?? "jobs";
  useEffect(() => {
    document.addEventListener("keydown", focusFilter);
    return () => document.removeEventListener("keydown", focusFilter);
  }, []);
  useEffect(() => {
    document.title = `${TITLES[name] ?? "Not found"} · trackloom`;
  }, [name]);
  return (
    <>
      <a class="skip" href="#main">
        Skip to content
      </a>
      <header class="top">
        <Link class="brand" href={pageHref({})}>
          trackloom
        </Link>
        <nav aria-label="Main">
          <Link href={pageHref({})} current={name === "jobs"}>
            Jobs
          </Link>
          <Link href={pageHref({ view: "new" })} current={name === "new"}>
            New job
          </Link>
          <Link
            href={pageHref({ view: "datasets" })}
            current={name === "datasets" || name === "dataset"}
          >
            Data
          </Link>
          <Link
            href={pageHref({ view: "sessions" })}
            current={name === "sessions" || name === "session"}
          >
            Live
          </Link>
          <a href="/docs">API</a>
        </nav>
        {isSignedIn.value && !isShut.value ? <SignOut /> : null}
        <ThemeSwitch />
      </header>
      <main id="main" tabIndex={-1}>
        {isShut.value ? <Login /> : view(name)}
      </main>
    </>
  );
}
