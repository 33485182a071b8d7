// What was asked and what came out: the request as the service understood it, and the files of the
// result.

import type { JSX } from "preact";
import { listArtifacts } from "../api/client";
import type { Job, Report } from "../api/types";
import { Icon, Loading, ProblemBox } from "../components/basics";
import { CopyButton } from "../components/copy";
import { useResource } from "../components/resource";
import { saveText } from "../components/save";
import { HeadRow, numberHead } from "../components/table-parts";
import { bytes } from "../format";

export function JobSpec({ job, report }: { job: Job; report: Report }): JSX.Element {
  const text = JSON.stringify(report.spec, null, 2);
  return (
    <div class="spec">
      <section>
        <h2>Files</h2>
        <Files id={job.id} />
      </section>
      <section>
        <div class="chart-head">
          <h2>Request</h2>
          <div class="chart-tools">
            <CopyButton text={text} />
            <button
              type="button"
              class="quiet"
              onClick={() =>
                saveText(text, `request-${job.id.slice(-12)}.json`, "application/json")
              }
            >
              <Icon name="download" /> JSON
            </button>
          </div>
        </div>
        <p class="muted small">
          sha256 <span class="mono">{job.spec_sha256}</span>
        </p>
        <pre class="code" tabIndex={0}>
          {text}
        </pre>
      </section>
    </div>
  );
}

function Files({ id }: { id: string }): JSX.Element {
  const files = useResource(() => listArtifacts(id), [id]);
  if (files.error) return <ProblemBox error={files.error} retry={files.reload} />;
  if (!files.data) return <Loading what="the files" />;
  return (
    <div class="table-scroll">
      <table class="data">
        <HeadRow heads={["File", "Type", numberHead("Size"), "sha256"]} />
        <tbody>
          {files.data.map((file) => (
            <tr>
              <td>
                <a href={file.href} download={file.name}>
                  {file.name}
                </a>
              </td>
              <td>{file.media_type}</td>
              <td class="num">{bytes(file.bytes)}</td>
              <td class="mono" title={file.sha256}>
                {file.sha256.slice(0, 16)}…
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}
