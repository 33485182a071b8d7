"""A service, and what is asked of it as a whole."""

from __future__ import annotations

import json
import uuid
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .connection import Connection
from .dataset import Dataset
from .job import Job

if TYPE_CHECKING:
    import pandas as pd


class Service:
    """A trackloom service at an address; `key` is one of its keys where it wants one."""

    def __init__(self, url: str = "http://127.0.0.1:8080", key: str | None = None, timeout_s: float = 10.0) -> None:
        self._connection = Connection(url, key, timeout_s)

    def version(self) -> str:
        """The version of the program that serves."""
        return str(self._connection.get("/v1/version")["version"])

    def upload(self, table: str | Path | bytes | pd.DataFrame, name: str | None = None, **options: Any) -> Dataset:
        """Uploads a file, its bytes, or a data frame with the columns that a CSV file has.

        Options are those of the operation `uploadRawDataset`: `kind`, `format`, `columns`, `sensors`, `origin` and others. What is no
        text or number is sent as JSON.

        Raises:
            Refused: with every fault of the file, its line and what is allowed.
        """
        content, file_name = _content(table)
        query = {"name": name, "file_name": file_name} | {key: _query(value) for key, value in options.items()}
        told = {key: value for key, value in query.items() if value is not None}
        headers = {"Content-Type": "application/octet-stream"}
        answer = self._connection.send("POST", "/v1/datasets/raw", params=told, content=content, headers=headers)
        return Dataset(self._connection, answer.json())

    def submit(self, request: dict[str, Any], **more: Any) -> Job:
        """Asks for a job and does not wait: a request with its `kind`, as `trackloom run` reads it."""
        headers = {"Idempotency-Key": str(uuid.uuid4())}
        answer = self._connection.send("POST", "/v1/jobs", json=request | more, headers=headers)
        return Job(self._connection, answer.json())

    def run(self, request: dict[str, Any], progress: Callable[[dict[str, Any]], object] | None = None, **more: Any) -> Job:
        """Asks for a job and waits for its end.

        Raises:
            Refused: with every fault of the request.
            JobFailed: it failed or was canceled.
        """
        return self.submit(request, **more).wait(progress)

    def job(self, job_id: str) -> Job:
        """A job by its id."""
        return Job(self._connection, self._connection.get(f"/v1/jobs/{job_id}"))

    def jobs(self, **filters: Any) -> Iterator[Job]:
        """All jobs, newest first; filters are those of the operation `listJobs`: `kind`, `state`, `label`, `q` and others."""
        for info in self._listed("/v1/jobs", filters):
            yield Job(self._connection, info)

    def dataset(self, dataset_id: str) -> Dataset:
        """A dataset by its id."""
        return Dataset(self._connection, self._connection.get(f"/v1/datasets/{dataset_id}"))

    def datasets(self, **filters: Any) -> Iterator[Dataset]:
        """All datasets, newest first."""
        for info in self._listed("/v1/datasets", filters):
            yield Dataset(self._connection, info)

    def preset(self, name: str) -> dict[str, Any]:
        """The request of a preset, to be run as it is or changed."""
        preset = self._connection.get(f"/v1/presets/{name}")
        return {"kind": preset["kind"]} | dict(preset["body"])

    def compare(self, first: Job, second: Job, confidence: float | None = None) -> dict[str, Any]:
        """How the second job differs from the first: paired differences with intervals, and which is better."""
        compared = self._connection.get("/v1/compare", job=[first.id, second.id], confidence=confidence)
        assert isinstance(compared, dict)
        return compared

    def _listed(self, path: str, filters: dict[str, Any]) -> Iterator[dict[str, Any]]:
        cursor = None
        while True:
            page = self._connection.get(path, cursor=cursor, **filters)
            yield from page["items"]
            cursor = page.get("next_cursor")
            if cursor is None:
                return


def _content(table: Any) -> tuple[bytes, str | None]:
    if isinstance(table, bytes):
        return table, None
    if isinstance(table, str | Path):
        path = Path(table)
        return path.read_bytes(), path.name
    text = table.to_csv(index=False)
    assert isinstance(text, str)
    return text.encode(), "table.csv"


def _query(value: Any) -> Any:
    if isinstance(value, dict | list):
        return json.dumps(value)
    return value
