import os
from trackloom_client import Client
from trackloom_client.api.datasets import upload_raw_dataset
from trackloom_client.api.jobs import create_associate_job
from trackloom_client.api.results import get_job_report
from trackloom_client.models import AssociateRequest, DatasetSource, DatasetSourceSource, SensorSettings
from trackloom_client.types import File

client = Client(base_url=os.environ["TRACKLOOM_URL"], timeout=60.0)
dataset = upload_raw_dataset.sync(client=client, body=File(payload=open("detections.csv", "rb")), name="trial 7")
source = DatasetSource(source=DatasetSourceSource.DATASET, dataset_id=dataset.id)
radar = SensorSettings(sensor_id="radar", p_d=0.95, clutter_per_m2=1e-9, sigma_x_m=10.0, sigma_y_m=10.0)
job = create_associate_job.sync(client=client, body=AssociateRequest(input_=source, sensors=[radar]), prefer="wait=30")
report = get_job_report.sync(client=client, id=job.id)
print(report.result.association.counts.detections, "detections")
