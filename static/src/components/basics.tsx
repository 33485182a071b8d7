// Small parts that every view uses: links inside the dashboard, icons, states, problems.

import type { ComponentChildren, JSX } from "preact";
import { ApiError } from "../api/client";
import type { Fault, JobState, Problem, Progress } from "../api/types";
import { capital, duration } from "../format";
import { go } from "../state/url";

interface LinkProps {
  href: string;
  class?: string;
  current?: boolean;
  label?: string;
  children: ComponentChildren;
}

/** A link inside the dashboard; with a modifier key it stays an ordinary link. */
export function Link({ href, current, label, children, ...rest }: LinkProps): JSX.Element {
  const follow = (event: MouseEvent) => {
    if (event.button !== 0 || event.ctrlKey || event.metaKey || event.shiftKey || event.altKey)
      return;
    event.preventDefault();
    go(href);
  };
  return (
    <a
      href={href}
      class={rest.class}
      aria-current={current ? "page" : undefined}
      aria-label={label}
      onClick={follow}
    >
      {children}
    </a>
  );
}

const PATHS = {
  queued: "M8 2a6 6 0 1 0 0 12A6 6 0 0 0 8 2Zm0 2.5V8l2.5 1.5",
  running: "M8 2a6 6 0 1 1-6 6",
  succeeded: "m3 8.5 3.2 3.2L13 5",
  failed: "m4 4 8 8m0-8-8 8",
  canceled: "M8 2a6 6 0 1 0 0 12A6 6 0 0 0 8 2ZM3.8 3.8l8.4 8.4",
  correct: "m3 8.5 3.2 3.2L13 5",
  missed: "M8 3a5 5 0 1 0 0 10A5 5 0 0 0 8 3Z",
  false: "m4 4 8 8m0-8-8 8",
  play: "M5 3.2v9.6l7.5-4.8Z",
  pause: "M5.5 3.5v9m5-9v9",
  back: "M11 3.5 5.5 8l5.5 4.5M4 3.5v9",
  forward: "m5 3.5 5.5 4.5L5 12.5m7-9v9",
  first: "M12 3.5 7.5 8l4.5 4.5M8 3.5 3.5 8 8 12.5",
  last: "M4 3.5 8.5 8 4 12.5m4-9L12.5 8 8 12.5",
  download: "M8 2.5v7m-3-3 3 3 3-3M3 13h10",
  table: "M2.5 3.5h11v9h-11ZM2.5 6.5h11M6.5 6.5v6",
  chart: "M2.5 2.5v11h11M5 10l2.5-3 2 1.5L13 4",
  plus: "M8 3v10M3 8h10",
  minus: "M3 8h10",
  fit: "M3 6V3h3m4 0h3v3m0 4v3h-3m-4 0H3v-3",
  ruler: "M2 11 11 2l3 3-9 9ZM5 8l1.5 1.5M7 6l1.5 1.5M9 4l1.5 1.5",
  warning: "M8 2.5 14 13H2Zm0 4V10m0 1.5v.3",
  link: [
    "M6.5 9.5 9.5 6.5M7.5 5 9.3 3.2a2.5 2.5 0 0 1 3.5 3.5L11 8.5",
    "M8.5 11l-1.8 1.8a2.5 2.5 0 0 1-3.5-3.5L5 7.5",
  ].join(""),
  close: "m4 4 8 8m0-8-8 8",
} as const;

export type IconName = keyof typeof PATHS;

export function Icon({ name }: { name: IconName }): JSX.Element {
  return (
    <svg class={`icon icon-${name}`} viewBox="0 0 16 16" aria-hidden="true">
      <path d={PATHS[name]} />
    </svg>
  );
}

export function StateBadge({
  state,
  canceling,
}: {
  state: JobState;
  canceling?: boolean;
}): JSX.Element {
  return (
    <span class={`badge state-${state}`}>
      <Icon name={state} />
      {canceling ? "canceling" : state}
    </span>
  );
}

export function ProgressBar({ progress }: { progress: Progress }): JSX.Element {
  const percent = Math.round(progress.fraction * 100);
  const left =
    progress.eta_s === null || progress.eta_s === undefined
      ? ""
      : ` · ${duration(progress.eta_s)} left`;
  return (
    <div class="progress">
      <progress
        max={1}
        value={progress.fraction}
        aria-label={`${progress.step}, ${percent} percent`}
      />
      <span class="progress-text">
        {progress.step} {percent} %<span class="muted">{left}</span>
      </span>
    </div>
  );
}

export function asProblem(error: unknown): Problem {
  if (error instanceof ApiError) return error.problem;
  return {
    type: "about:blank",
    title: "Something went wrong here",
    status: 0,
    code: "dashboard",
    detail: String(error),
  };
}

export function FaultText({ fault }: { fault: Fault }): JSX.Element {
  const place = [
    fault.line ? `line ${fault.line}` : "",
    fault.column ? `column ${fault.column}` : "",
  ]
    .filter(Boolean)
    .join(", ");
  return (
    <>
      {capital(fault.detail)}
      {fault.allowed ? <span class="muted"> · allowed: {fault.allowed}</span> : null}
      {place ? <span class="muted"> · {place}</span> : null}
    </>
  );
}

/** A problem of the service in full: what, why, and each fault with its place. */
export function ProblemBox({ error, retry }: { error: unknown; retry?: () => void }): JSX.Element {
  const problem = asProblem(error);
  return (
    <section class="problem" role="alert">
      <h3>
        <Icon name="warning" /> {problem.title}
      </h3>
      {problem.detail ? <p>{problem.detail}</p> : null}
      {problem.errors?.length ? (
        <ul class="faults">
          {problem.errors.map((fault) => (
            <li>
              <code>{fault.pointer || "/"}</code> <FaultText fault={fault} />
            </li>
          ))}
        </ul>
      ) : null}
      <p class="muted small">
        {problem.code}
        {problem.request_id ? ` · request ${problem.request_id}` : ""}
      </p>
      {retry ? (
        <button type="button" onClick={retry}>
          Try again
        </button>
      ) : null}
    </section>
  );
}

export function Loading({ what }: { what: string }): JSX.Element {
  return (
    <p class="loading" role="status">
      <Icon name="running" /> Loading {what}…
    </p>
  );
}

export function Empty({
  title,
  children,
}: {
  title: string;
  children?: ComponentChildren;
}): JSX.Element {
  return (
    <div class="empty">
      <p class="empty-title">{title}</p>
      {children}
    </div>
  );
}
