"""Talks to a trackloom service.

>>> import trackloom
>>> service = trackloom.Service("http://127.0.0.1:8080")
>>> recording = service.upload("detections.csv")
>>> job = service.run({"kind": "associate", "input": recording.source})
>>> job.table("tracks.csv").groupby("track_id").size()
"""

from .dataset import Dataset
from .errors import Fault, JobFailed, Refused
from .job import Job
from .service import Service

__all__ = ["Dataset", "Fault", "Job", "JobFailed", "Refused", "Service"]
