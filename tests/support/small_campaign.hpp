/// A campaign that takes a second: a simulated aircraft, two motion models, two noises.
#pragma once

namespace pelorus::test {

constexpr const char* small_campaign = R"(pelorus: 1
title: an aircraft
run: {seed: 7}
graph:
  world:
    use: source.simulation
    with: {scans: 20, period: 1 s}
    parts:
      targets:
        aircraft: {use: trajectory.legs, with: {start: [-3 km, 0 m, 1 km], speed: 80 m/s, heading: 10 deg}}
      sensors:
        radar: {use: sensor.position, with: {noise: 10 m}}
  tracker:
    use: tracker.point_target
    with: {maximum_speed: 300 m/s}
    in: {scans: world.scans}
    parts:
      estimator:
        use: estimator.kalman
        parts:
          motion: {use: motion.constant_velocity, with: {noise: 1 m2/s3}}
          sensors: {radar: {like: world.sensors.radar}}
  errors: {use: analyzer.tracking_error, in: {tracks: tracker.tracks, truth: world.truth}}
  files: {use: sink.csv, in: {tracks: tracker.tracks, truth: world.truth, scans: world.scans}}
campaign:
  runs: 8
  sweep: {world.sensors.radar.noise: [5 m, 10 m]}
  variants: {calm: {}, lively: {tracker.estimator.motion.noise: 20 m2/s3}}
)";

}  // namespace pelorus::test
