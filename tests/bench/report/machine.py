"""Where and when it was measured: processor, system, compiler, commit, and what else was running."""
import datetime
import os
import pathlib
import platform
import re
import resource
import subprocess


def output(*command, cwd=None):
    return subprocess.run(command, capture_output=True, text=True, cwd=cwd).stdout.strip()


def first(pattern, text, otherwise="unknown"):
    found = re.search(pattern, text)
    return found[1].strip() if found else otherwise


def package_version(package):
    version = output("dpkg-query", "-W", "-f", "${Version}", package)
    return re.sub(r"^\d+:|[-+].*$", "", version) or "not installed"


def about(root, build):
    cpu = pathlib.Path("/proc/cpuinfo").read_text()
    memory_kib = int(first(r"MemTotal:\s+(\d+)", pathlib.Path("/proc/meminfo").read_text(), "0"))
    cache = (build / "CMakeCache.txt").read_text()
    compiler = first(r"CMAKE_CXX_COMPILER:\w+=(.*)", cache, "c++")
    changed = output("git", "status", "--porcelain", "--untracked-files=no", "--", ".", ":!docs", cwd=root)
    return {
        "processor": first(r"model name\s*:\s*(.*)", cpu),
        "family": first(r"cpu family\s*:\s*(.*)", cpu), "model": first(r"\nmodel\s*:\s*(.*)", cpu),
        "cores": os.cpu_count(), "memory_gib": round(memory_kib / 2**20),
        "virtual": "hypervisor" in cpu,
        "system": first(r'PRETTY_NAME="(.*)"', pathlib.Path("/etc/os-release").read_text()),
        "kernel": platform.release(),
        "compiler": output(os.path.realpath(compiler), "--version").splitlines()[0],
        "flags": first(r"CMAKE_CXX_FLAGS_RELEASE:\w+=(.*)", cache),
        "version": (root / "VERSION").read_text().strip(),
        "commit": output("git", "rev-parse", "--short", "HEAD", cwd=root) + (" with changes" if changed else ""),
        "date": datetime.date.today().isoformat(),
        "packages": {name: package_version(name) for name in
                     ("libbox2d-dev", "libchipmunk-dev", "libga-dev", "python3-deap", "valgrind")},
    }


class Load:
    """What others take of the machine's processors from begin() to report()."""

    def __init__(self):
        self.at_start = os.getloadavg()[0]

    def begin(self):
        self.began = self.now()

    @staticmethod
    def now():
        """Seconds: of a clock, of all processors' work, of ours and our children's."""
        fields = [int(x) for x in pathlib.Path("/proc/stat").read_text().splitlines()[0].split()[1:]]
        user, nice, system, _, _, irq, softirq, steal = fields[:8]
        ticks = os.sysconf("SC_CLK_TCK")
        own = sum(usage.ru_utime + usage.ru_stime for usage in
                  map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)))
        uptime = float(pathlib.Path("/proc/uptime").read_text().split()[0])
        return uptime, (user + nice + system + irq + softirq + steal) / ticks, own

    def report(self):
        clock, work, own = (b - a for a, b in zip(self.began, self.now()))
        return {"load_before": round(self.at_start, 2), "minutes": round(clock / 60, 1),
                "others_cores": round(max(0.0, (work - own) / clock), 2)}
