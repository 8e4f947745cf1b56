#!/usr/bin/env python3
"""Makes radar_recording.csv.gz, the recording that configs/recorded_radar.yaml plays: see README.md.

    python3 make_radar_recording.py > radar_recording.csv.gz

Needs nothing but Python 3 and gives the same bytes every time.
"""

import gzip
import io
import math
import random
import sys

PERIOD = 2.0  # s, between scans
SCANS = 150
DETECTION = 0.9  # probability
FALSE_ALARMS = 6.0  # a scan, on average
NOISE = (25.0, math.radians(0.15), math.radians(0.2))  # range (m), bearing, elevation (rad)
RANGES = (2000.0, 45000.0)  # m, of false alarms
ELEVATIONS = (0.0, math.radians(12.0))

# Aircraft: identity, first scan, last scan, place (m, east north up), speed (m/s), course (deg from north), and legs of
# (duration s, turn rate deg/s to the right, climb m/s).
AIRCRAFT = [
    (1001, 0, 149, (-30000, 8000, 4000), 210, 92, [(300, 0.0, 0.0)]),
    (1002, 0, 149, (25000, -15000, 6000), 230, 318, [(80, 0.0, 0.0), (60, 1.5, 0.0), (160, 0.0, 0.0)]),
    (1003, 0, 149, (6000, 22000, 2500), 120, 200, [(60, 0.0, -3.0), (90, -2.0, -3.0), (150, 0.0, 0.0)]),
    (1004, 20, 149, (-12000, -24000, 1500), 160, 20, [(100, 0.0, 8.0), (40, 3.0, 0.0), (200, 0.0, 0.0)]),
    (1005, 40, 149, (32000, 12000, 7000), 240, 265, [(300, 0.0, 0.0)]),
    # Two that fly side by side, 600 m apart, until one turns off.
    (1006, 0, 149, (-20000, -9000, 5000), 180, 70, [(300, 0.0, 0.0)]),
    (1007, 0, 149, (-19800, -9560, 5000), 180, 70, [(140, 0.0, 0.0), (45, 2.0, 0.0), (200, 0.0, 0.0)]),
]


def fly(start, speed, course, legs, time):
    """Place and velocity after `time`: legs of constant turn rate and climb."""
    east, north, up = start
    course = math.radians(course)
    for duration, turn, climb in legs:
        span = min(duration, time)
        rate = math.radians(turn)
        after = course + rate * span
        if rate == 0.0:
            east += speed * span * math.sin(course)
            north += speed * span * math.cos(course)
        else:
            east += speed / rate * (math.cos(course) - math.cos(after))
            north += speed / rate * (math.sin(after) - math.sin(course))
        up += climb * span
        course = after
        time -= span
        if time <= 0.0:
            return (east, north, up), (speed * math.sin(course), speed * math.cos(course), climb)
    raise ValueError("the legs are too short")


def look(place):
    """Range, bearing (clockwise from north) and elevation of a place, seen from the origin."""
    east, north, up = place
    ground = math.hypot(east, north)
    return math.hypot(ground, up), math.atan2(east, north), math.atan2(up, ground)


def poisson(mean, draw):
    """Knuth's way: as many factors as it takes to fall below exp(-mean)."""
    limit, product, count = math.exp(-mean), draw.random(), 0
    while product > limit:
        product *= draw.random()
        count += 1
    return count


def cells(measurement):
    distance, bearing, elevation = measurement
    degrees = math.degrees(bearing) % 360.0
    return ["%.4f" % (distance / 1000.0), "%.3f" % degrees, "%.3f" % math.degrees(elevation)]


def rows(draw):
    yield "time_s,range_km,bearing_deg,elevation_deg,aircraft,east_m,north_m,up_m,v_east,v_north,v_up"
    for scan in range(SCANS):
        time = scan * PERIOD
        plots = []
        for identity, first, last, start, speed, course, legs in AIRCRAFT:
            if not first <= scan <= last:
                continue
            place, velocity = fly(start, speed, course, legs, (scan - first) * PERIOD)
            seen = [value + draw.gauss(0.0, sigma) for value, sigma in zip(look(place), NOISE)]
            measured = cells(seen) if draw.random() < DETECTION else ["", "", ""]
            truth = ["%.1f" % value for value in place] + ["%.2f" % value for value in velocity]
            plots.append(measured + [str(identity)] + truth)
        for _ in range(poisson(FALSE_ALARMS, draw)):
            # Uniform over the ground: the density of the range grows with the range.
            low, high = (r * r for r in RANGES)
            false = (math.sqrt(draw.uniform(low, high)), draw.uniform(0.0, 2.0 * math.pi), draw.uniform(*ELEVATIONS))
            plots.append(cells(false) + [""] * 7)
        draw.shuffle(plots)
        for plot in plots:
            yield ",".join(["%g" % time] + plot)


def main():
    text = "\n".join(rows(random.Random(20160112))) + "\n"
    packed = io.BytesIO()
    with gzip.GzipFile(filename="", mode="wb", compresslevel=9, fileobj=packed, mtime=0) as file:
        file.write(text.encode())
    sys.stdout.buffer.write(packed.getvalue())


main()
