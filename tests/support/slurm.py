# SPDX-License-Identifier: MIT
"""A Slurm of one node, this machine, with its daemons under this user and all its files in one
folder."""

import os
import re
import shutil
import socket
import subprocess
import time

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "sinfo", "squeue", "srun")
CONFIGURATION = """
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
JobAcctGatherType=jobacct_gather/none
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmdParameters=config_overrides
MinJobAge=300
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory={memory} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


class Missing(Exception):
    """Why there is no Slurm here."""


def path_with_sbin():
    return os.environ["PATH"] + ":/usr/sbin:/sbin"


def free_ports(count):
    held = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [one.getsockname()[1] for one in held]
    for one in held:
        one.close()
    return ports


class Slurm:
    """The daemons run while this is open; `environment` is that of its clients."""

    def __init__(self, folder):
        self.folder, self.daemons = folder, []
        self.environment = dict(os.environ, PATH=f"{folder}/bin:{path_with_sbin()}",
                                SLURM_CONF=str(folder / "slurm.conf"))
        missing = [name for name in PROGRAMS if not shutil.which(name, path=path_with_sbin())]
        if missing:
            raise Missing(f"{missing[0]} is missing (Debian: slurm-wlm, munge)")
        self.srun = shutil.which("srun", path=path_with_sbin())

    def __enter__(self):
        try:
            self.start()
        except Missing:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for process in reversed(self.daemons):
            process.terminate()
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def daemon(self, *command):
        with open(self.folder / f"{command[0]}.out", "wb") as log:
            self.daemons.append(subprocess.Popen(list(map(str, command)), stdout=log, stderr=log,
                                                 env=self.environment, cwd=self.folder))

    def start(self):
        own = self.folder
        own.chmod(0o755)  # munged refuses a socket that other users cannot reach
        (own / "key").write_bytes(os.urandom(128))
        (own / "key").chmod(0o600)
        for name in ("state", "spool", "bin"):
            (own / name).mkdir()
        host = socket.gethostname().split(".")[0]
        user = subprocess.check_output(["id", "-un"], text=True).strip()
        memory = re.search(r"MemTotal: *(\d+)", open("/proc/meminfo").read())
        (own / "slurm.conf").write_text(CONFIGURATION.format(
            folder=own, host=host, user=user, ports=free_ports(2), cpus=os.cpu_count(),
            memory=int(memory[1]) // 1024))
        # Snakemake's job steps drop SLURM_CONF, so srun would look for the cluster in /etc/slurm.
        (own / "bin" / "srun").write_text(f'#!/bin/sh\nSLURM_CONF={own}/slurm.conf exec '
                                          f'{self.srun} "$@"\n')
        (own / "bin" / "srun").chmod(0o755)
        self.daemon("munged", "--foreground", "--force", "--num-threads=2", f"--key-file={own}/key",
                    f"--socket={own}/munge.socket", f"--pid-file={own}/munged.pid",
                    f"--log-file={own}/munged.log", f"--seed-file={own}/munged.seed")
        self.until(lambda: (own / "munge.socket").exists())
        self.daemon("slurmctld", "-D", "-f", own / "slurm.conf")
        self.daemon("slurmd", "-D", "-f", own / "slurm.conf", "-N", host)
        self.until(lambda: "idle" in self.say("sinfo", "--noheader", "--format=%T"))

    def say(self, *command):
        return subprocess.run(list(map(str, command)), env=self.environment, capture_output=True,
                              text=True).stdout

    def until(self, ready, seconds=40):
        end = time.monotonic() + seconds
        while not ready():
            dead = [process for process in self.daemons if process.poll() is not None]
            if dead or time.monotonic() > end:
                name = os.path.basename((dead or self.daemons[-1:])[0].args[0])
                log = (self.folder / f"{name}.out").read_text(errors="replace").strip().splitlines()
                raise Missing(f"{name} does not start: {log[-1] if log else 'it says nothing'}")
            time.sleep(0.2)
