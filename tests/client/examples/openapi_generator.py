import os
from openapi_client import ApiClient, Configuration, DatasetsApi, JobsApi, ResultsApi
from openapi_client.models import AssociateRequest, DatasetSource, InputSource, SensorSettings

client = ApiClient(Configuration(host=os.environ["TRACKLOOM_URL"]))
dataset = DatasetsApi(client).upload_raw_dataset(open("detections.csv", "rb").read(), name="trial 7")
source = InputSource(DatasetSource(source="dataset", dataset_id=dataset.id))
radar = SensorSettings(sensor_id="radar", p_d=0.95, clutter_per_m2=1e-9, sigma_x_m=10.0, sigma_y_m=10.0)
job = JobsApi(client).create_associate_job(AssociateRequest(input=source, sensors=[radar]), prefer="wait=30")
report = ResultsApi(client).get_job_report(job.id).actual_instance
print(report.result.association.counts.detections, "detections")
