"""Jobs of a service."""

from __future__ import annotations

import html
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .connection import Connection
from .dataset import read_table
from .errors import JobFailed

if TYPE_CHECKING:
    import pandas as pd

_ENDED = {"succeeded", "failed", "canceled"}
_WAIT_S = 30


class Job:
    """A job, as it was when it was last asked for."""

    def __init__(self, connection: Connection, info: dict[str, Any]) -> None:
        self._connection = connection
        self.info = info
        self._report: dict[str, Any] | None = None

    @property
    def id(self) -> str:
        """The id that requests name."""
        return str(self.info["id"])

    @property
    def state(self) -> str:
        """`queued`, `running`, `succeeded`, `failed` or `canceled`."""
        return str(self.info["state"])

    @property
    def source(self) -> dict[str, str]:
        """As a request names what it made: `{"tracks": job.source}`."""
        return {"source": "job", "job_id": self.id}

    def refresh(self, wait_s: int = 0) -> Job:
        """Asks for the job again, at the latest after so many seconds or when it has ended."""
        headers = {"Prefer": f"wait={wait_s}"} if wait_s else {}
        self.info = self._connection.send("GET", f"/v1/jobs/{self.id}", headers=headers).json()
        return self

    def wait(self, progress: Callable[[dict[str, Any]], object] | None = None) -> Job:
        """Waits for its end; `progress` is told the job each time that it is asked for.

        Raises:
            JobFailed: it failed or was canceled.
        """
        while self.state not in _ENDED:
            self.refresh(1 if progress else _WAIT_S)
            if progress:
                progress(self.info)
        if self.state != "succeeded":
            raise JobFailed(self.info)
        return self

    def cancel(self) -> Job:
        """Asks it to stop."""
        self.info = self._connection.send("POST", f"/v1/jobs/{self.id}/cancel").json()
        return self

    def delete(self) -> None:
        """Deletes it with what it made."""
        self._connection.send("DELETE", f"/v1/jobs/{self.id}")

    @property
    def report(self) -> dict[str, Any]:
        """The report of a job that succeeded."""
        if self._report is None:
            self._report = self._connection.get(f"/v1/jobs/{self.id}/report")
        return self._report

    @property
    def result(self) -> dict[str, Any]:
        """What the job found: the same for the same request, seed and inputs."""
        result = self.report["result"]
        assert isinstance(result, dict)
        return result

    @property
    def met(self) -> bool | None:
        """Whether its limits are met; `None` of a job without limits."""
        limits = self.result.get("limits")
        return bool(limits["met"]) if isinstance(limits, dict) else None

    def artifacts(self) -> list[str]:
        """The names of its files."""
        items = self._connection.get(f"/v1/jobs/{self.id}/artifacts")["items"]
        return [str(item["name"]) for item in items]

    def artifact(self, name: str) -> bytes:
        """One of its files."""
        return self._connection.send("GET", f"/v1/jobs/{self.id}/artifacts/{name}").content

    def save(self, name: str, folder: str | Path = ".") -> Path:
        """Writes one of its files into a folder."""
        path = Path(folder) / name
        path.write_bytes(self.artifact(name))
        return path

    def table(self, name: str = "tracks.csv") -> pd.DataFrame:
        """One of its CSV files as a data frame. Needs pandas."""
        return read_table(self.artifact(name))

    def metrics(self) -> pd.DataFrame:
        """Every quantity of every metric: metric, quantity, value, unit. Needs pandas."""
        import pandas as pd

        rows = []
        for metric, told in (self.result.get("metrics") or {}).items():
            for name, quantity in told["quantities"].items():
                rows.append({"metric": metric, "quantity": name, "value": quantity["value"], "unit": quantity["unit"]})
        return pd.DataFrame(rows, columns=["metric", "quantity", "value", "unit"])

    def page(self) -> str:
        """The report as one page of HTML that loads nothing."""
        return self._connection.send("GET", f"/v1/jobs/{self.id}/report.html").text

    def _repr_html_(self) -> str | None:
        """In a notebook: the page with its player, verdicts and pictures."""
        if self.state != "succeeded":
            return None
        page = html.escape(self.page(), quote=True)
        return f'<iframe srcdoc="{page}" style="width: 100%; height: 45rem; border: 0" title="report of the job"></iframe>'

    def __repr__(self) -> str:
        return f"<Job {self.info.get('name') or self.id}: {self.info['kind']}, {self.state}>"
