// The data sets: what was uploaded and what jobs made, with a place to upload more.

import { useSignal } from "@preact/signals";
import type { JSX, TargetedEvent } from "preact";
import { useEffect } from "preact/hooks";
import { type DatasetFilter, pageOfDatasets } from "../api/client";
import type { Dataset } from "../api/types";
import { Empty, Icon, Link, Loading, ProblemBox } from "../components/basics";
import { HeadRow, numberHead, TableScroll } from "../components/table-parts";
import { Upload } from "../form/upload";
import { bytes, count, moment, plural } from "../format";
import { go, pageHref, param, setParams } from "../state/url";
import { useDrop } from "../upload/drop";

const KINDS = ["detections", "truth", "tracks", "bearing_time"];
const PAGE = 50;

interface Listing {
  sets: Dataset[];
  next?: string | null | undefined;
}

function query(): DatasetFilter {
  const [kind, q] = [param("kind"), param("q")];
  return { limit: PAGE, ...(kind ? { kind } : {}), ...(q ? { q } : {}) };
}

export function Datasets(): JSX.Element {
  const listing = useSignal<Listing | undefined>(undefined);
  const error = useSignal<unknown>(undefined);
  const round = useSignal(0);
  const asked = query();
  const key = JSON.stringify(asked);
  useEffect(() => {
    let current = true;
    listing.value = undefined;
    error.value = undefined;
    pageOfDatasets(asked).then(
      (page) => {
        if (current) listing.value = { sets: page.items, next: page.next_cursor };
      },
      (failure: unknown) => {
        if (current) error.value = failure;
      },
    );
    return () => {
      current = false;
    };
  }, [key, round.value]);
  const more = async () => {
    const before = listing.peek();
    if (!before?.next) return;
    try {
      const page = await pageOfDatasets({ ...asked, cursor: before.next });
      listing.value = { sets: [...before.sets, ...page.items], next: page.next_cursor };
    } catch (failure) {
      error.value = failure;
    }
  };
  const waiting = useSignal<File[]>([]);
  const isOver = useDrop((files) => {
    waiting.value = files;
    setParams({ upload: "1" });
  });
  const [dropped, ...rest] = waiting.value;
  const done = (dataset: Dataset) => {
    if (!rest.length) go(pageHref({ view: "dataset", dataset: dataset.id }));
    waiting.value = rest;
    round.value += 1;
  };
  const uploading = param("upload") === "1";
  return (
    <section class={isOver ? "drop-page over" : "drop-page"}>
      <div class="title-row">
        <h1>Data sets</h1>
        <button
          type="button"
          class="primary"
          aria-expanded={uploading}
          onClick={() => {
            waiting.value = [];
            setParams({ upload: uploading ? null : "1", like: null });
          }}
        >
          <Icon name="plus" /> Upload a file
        </button>
      </div>
      {uploading ? (
        <Upload
          id="upload"
          expected={undefined}
          dropped={dropped}
          like={param("like") ?? undefined}
          unlike={() => setParams({ like: null })}
          done={done}
        />
      ) : null}
      {uploading && rest.length ? (
        <Waiting files={rest} skip={() => (waiting.value = rest)} />
      ) : null}
      <Filters />
      {error.value ? <ProblemBox error={error.value} retry={() => (round.value += 1)} /> : null}
      {listing.value ? (
        <List listing={listing.value} more={() => void more()} />
      ) : error.value ? null : (
        <Loading what="data sets" />
      )}
    </section>
  );
}

/** The files that were dropped with the one in the form: each comes when it is done. */
function Waiting({ files, skip }: { files: File[]; skip: () => void }): JSX.Element {
  return (
    <p class="row" role="status">
      <span>
        {plural(files.length, "more file")}: {files.map((file) => file.name).join(", ")}
      </span>
      <button type="button" onClick={skip}>
        Skip this one
      </button>
    </p>
  );
}

function Filters(): JSX.Element {
  const choose = (event: TargetedEvent<HTMLSelectElement>) =>
    setParams({ kind: event.currentTarget.value });
  return (
    <form class="filters" role="search" onSubmit={(event) => event.preventDefault()}>
      <label>
        <span>Kind</span>
        <select value={param("kind") ?? ""} onChange={choose}>
          <option value="">all</option>
          {KINDS.map((kind) => (
            <option value={kind}>{kind}</option>
          ))}
        </select>
      </label>
      <label class="grow">
        <span>Name or id</span>
        <input
          type="search"
          data-filter
          value={param("q") ?? ""}
          placeholder="Press / to filter"
          onInput={(event) => setParams({ q: event.currentTarget.value })}
        />
      </label>
    </form>
  );
}

const HEADS = [
  "Name",
  "Kind",
  ...["Rows", "Scans", "Size"].map(numberHead),
  "Origin",
  numberHead("Created"),
];

function SetRow({ set }: { set: Dataset }): JSX.Element {
  return (
    <tr>
      <td class="wrap">
        <Link href={pageHref({ view: "dataset", dataset: set.id })}>{set.name}</Link>
        {set.warnings.length ? (
          <span class="sub">{plural(set.warnings.length, "warning")}</span>
        ) : null}
      </td>
      <td>{set.kind}</td>
      <td class="num">{count(set.rows)}</td>
      <td class="num">{set.scans ? count(set.scans) : "–"}</td>
      <td class="num">{bytes(set.bytes)}</td>
      <td>
        {set.origin.kind === "job" ? (
          <Link href={pageHref({ view: "job", job: set.origin.job_id })}>
            job {set.origin.job_id.slice(-12)}
          </Link>
        ) : (
          "upload"
        )}
      </td>
      <td class="num">
        <time dateTime={set.created_at}>{moment(set.created_at)}</time>
      </td>
    </tr>
  );
}

function List({ listing, more }: { listing: Listing; more: () => void }): JSX.Element {
  if (!listing.sets.length) {
    return (
      <Empty
        title={
          param("kind") || param("q") ? "No data set matches these filters." : "No data sets yet."
        }
      >
        <p>Drop a recording on this page, or run a job: what it makes is kept here, too.</p>
      </Empty>
    );
  }
  return (
    <>
      <TableScroll label="Data sets" class="table-scroll">
        <table class="data">
          <HeadRow heads={HEADS} />
          <tbody>
            {listing.sets.map((set) => (
              <SetRow key={set.id} set={set} />
            ))}
          </tbody>
        </table>
      </TableScroll>
      {listing.next ? (
        <p class="more">
          <button type="button" onClick={more}>
            Load more
          </button>
          <span class="muted">{count(listing.sets.length)} shown</span>
        </p>
      ) : null}
    </>
  );
}
