"""What a viewer costs the simulation, and how long commands take, on a real evod.

    viewer_cost.py EVOD MESSAGES [organisms] [runs]

The same ticks of the same run are simulated again and again at full speed on one thread, by turns with a subscriber at
30 pictures a second and without one; what is compared is the processor time of the simulation thread for those ticks.
"""
import os
import secrets
import socket
import statistics
import struct
import subprocess
import sys
import threading
import time

evod_path, messages_path = sys.argv[1:3]
organisms = int(sys.argv[3]) if len(sys.argv) > 3 else 10_000
runs = int(sys.argv[4]) if len(sys.argv) > 4 else 11
sys.path.insert(0, messages_path)

from evod.v1 import commands_pb2 as c, session_pb2, world_pb2 as w  # noqa: E402

area_px2 = organisms * 46_080
parameters = {"population_size": organisms, "food_count": organisms * 3, "poison_count": organisms * 2,
              "island_width_px": (area_px2 * 16 / 9) ** 0.5, "island_height_px": (area_px2 * 9 / 16) ** 0.5}
first_tick, last_tick = 60, 60 + max(100, 6_000_000 // organisms)


class Client:
    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port))
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.key, self.id = secrets.token_hex(8), 0
        self.send(session_pb2.ClientMessage(hello=session_pb2.Hello(protocol_version=1, client_name="viewer_cost")))
        self.frame()

    def send(self, message):
        body = message.SerializeToString()
        self.socket.sendall(b"EV\x01\x01" + struct.pack("<I", len(body)) + body)

    def read(self, count):
        data = bytearray(count)
        view, got = memoryview(data), 0
        while got < count:
            more = self.socket.recv_into(view[got:])
            if more == 0:
                raise EOFError
            got += more
        return data

    def frame(self):
        header = self.read(8)
        return header[3], self.read(struct.unpack("<I", header[4:])[0])

    def call(self, **request):
        self.id += 1
        self.send(session_pb2.ClientMessage(request=c.Request(request_id=self.id, client_key=self.key, **request)))
        while True:
            channel, body = self.frame()
            if channel == 1:
                response = session_pb2.ServerMessage.FromString(bytes(body)).response
                assert response.status.code == 0, response.status
                return response

    def run_to(self, tick):
        self.call(run_until_tick=c.RunUntilTick(world="w", tick=tick))
        while next(x for x in self.call(list_worlds=c.ListWorlds()).worlds.worlds if x.name == "w").tick < tick:
            time.sleep(0.005)


def start(*options):
    began = time.perf_counter()
    process = subprocess.Popen([evod_path, "--port", "0", *options], stdout=subprocess.PIPE, text=True)
    line = process.stdout.readline()
    port = int(line.split("listening on ")[1].split(",")[0].rsplit(":")[1])
    Client(port)
    return process, port, time.perf_counter() - began


def simulation_thread_s(pid):
    for task in os.listdir(f"/proc/{pid}/task"):
        if open(f"/proc/{pid}/task/{task}/comm").read().strip() == "simulation":
            return int(open(f"/proc/{pid}/task/{task}/schedstat").read().split()[0]) / 1e9
    raise RuntimeError("no simulation thread")


def median_ms(values):
    return f"median {statistics.median(values) * 1e3:.2f} ms, worst {max(values) * 1e3:.2f} ms"


starts = []
for _ in range(9):
    process, port, took = start()
    starts.append(took)
    process.terminate()
    process.wait()
print(f"from exec to the first welcome: {median_ms(starts)}")

process, port, _ = start("--threads", "1")
control = Client(port)
control.call(create_world=c.CreateWorld(name="w", seed=1, parameters=[
    w.ParameterAssignment(name=n, value=w.ParameterValue(**{"count" if isinstance(v, int) else "real": v}))
    for n, v in parameters.items()]))
control.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(max=True)))

per_tick = {True: [], False: []}
rates = {True: [], False: []}
pictures = picture_bytes = 0
for run in range(2 * runs):
    watched = run % 2 == 1
    control.call(reset_world=c.ResetWorld(world="w"))
    viewer = None
    if watched:
        viewer = Client(port)
        viewer.call(subscribe_snapshots=c.SubscribeSnapshots(world="w", rate_hz=30))

        def read_on():
            global pictures, picture_bytes
            try:
                while True:
                    channel, body = viewer.frame()
                    if channel == 2:
                        pictures += 1
                        picture_bytes = len(body)
            except (EOFError, OSError):
                pass

        reader = threading.Thread(target=read_on)
        reader.start()
    control.run_to(first_tick)
    before, began = simulation_thread_s(process.pid), time.perf_counter()
    control.run_to(last_tick)
    rates[watched].append((last_tick - first_tick) / (time.perf_counter() - began))
    per_tick[watched].append((simulation_thread_s(process.pid) - before) / (last_tick - first_tick))
    if viewer:
        viewer.socket.shutdown(socket.SHUT_RDWR)
        reader.join()

alone, watched = (statistics.median(per_tick[x]) for x in (False, True))
ratios = sorted(b / a for a, b in zip(per_tick[False], per_tick[True]))
print(f"{organisms} organisms, {parameters['food_count'] + parameters['poison_count']} items, "
      f"{last_tick - first_tick} ticks, {runs} pairs of runs; pictures of {picture_bytes} bytes, {pictures} of them")
print(f"simulation thread, alone:   {alone * 1e6:.0f} µs a tick")
print(f"simulation thread, watched: {watched * 1e6:.0f} µs a tick")
print(f"a viewer at 30 Hz costs it {100 * (statistics.median(ratios) - 1):+.2f} % "
      f"(pairs {100 * (ratios[0] - 1):+.2f} to {100 * (ratios[-1] - 1):+.2f} %)")

control.call(run=c.Run(world="w"))
for name, request in (("a command, beside that world at full speed", {"set_speed": c.SetSpeed(world="w", speed=w.Speed(max=True))}),
                      ("a query, beside it", {"list_worlds": c.ListWorlds()})):
    times = []
    for _ in range(300):
        began = time.perf_counter()
        control.call(**request)
        times.append(time.perf_counter() - began)
    print(f"{name}: {median_ms(times)}")
control.call(pause=c.Pause(world="w"))
times = []
for _ in range(1000):
    began = time.perf_counter()
    control.call(pause=c.Pause(world="w"))
    times.append(time.perf_counter() - began)
print(f"a command to a server at rest: {median_ms(times)}")
process.terminate()
process.wait()
