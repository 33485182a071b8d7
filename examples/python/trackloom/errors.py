"""What a service may answer instead of a result."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong with a request or a file."""

    pointer: str
    code: str
    detail: str
    allowed: str | None = None
    line: int | None = None


class Refused(Exception):
    """A request was refused; `code` names the problem, `faults` has every fault with its place."""

    def __init__(self, status: int, problem: dict[str, Any]) -> None:
        self.status = status
        self.code = str(problem.get("code", "unknown"))
        self.detail = str(problem.get("detail", ""))
        self.faults = [_fault(found) for found in problem.get("errors") or []]
        lines = [f"{status} {self.code}: {self.detail}"]
        for fault in self.faults:
            allowed = f" (allowed: {fault.allowed})" if fault.allowed else ""
            lines.append(f"  {fault.pointer}: {fault.detail}{allowed}")
        super().__init__("\n".join(lines))


class JobFailed(Exception):
    """A job ended without a result; `job` is as it ended."""

    def __init__(self, job: dict[str, Any]) -> None:
        self.job = job
        error = job.get("error") or {}
        super().__init__(f"job {job['id']} is {job['state']}: {error.get('detail', 'no detail')}")


def _fault(found: dict[str, Any]) -> Fault:
    return Fault(
        pointer=str(found.get("pointer", "")),
        code=str(found.get("code", "")),
        detail=str(found.get("detail", "")),
        allowed=found.get("allowed"),
        line=found.get("line"),
    )
