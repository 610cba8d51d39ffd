"""Runs the tasks of a campaign with the Python package of HyperQueue: hq.py TASKS SCRIPT LOGS.

A server that runs is used; without one, a cluster of this machine alone is started, and ends with this script.
"""

import sys
from pathlib import Path

from hyperqueue import Client, Job, LocalCluster
from hyperqueue.cluster import WorkerConfig

tasks, script, logs = int(sys.argv[1]), sys.argv[2], Path(sys.argv[3])


def run(client):
    job = Job(max_fails=None)
    for task in range(1, tasks + 1):
        log = str(logs / f"hq-{task}.log")
        job.program(["sh", script], env={"GRAINLAB_TASK": str(task)}, stdout=log, stderr=log)
    client.wait_for_jobs([client.submit(job)], raise_on_error=False)


try:
    client = Client()
except Exception:  # noqa: BLE001: the package has no type of its own for a missing server
    with LocalCluster(worker_config=WorkerConfig()) as cluster:
        run(cluster.client())
else:
    run(client)
