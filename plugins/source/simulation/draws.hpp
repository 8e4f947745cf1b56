/// Random numbers of a simulation. Every draw has a key of its own: what, sensor, target, tick, object, point. So the order in which
/// things are computed does not matter, and adding a sensor or a target changes nothing for the others.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <pelorus/abi/random.h>

namespace simulation {

/// FNV-1a, 64 bits: a number for a part's name.
inline std::uint64_t number_of(const std::string& name) noexcept {
    std::uint64_t hash = 14695981039346656037u;
    for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
    return hash;
}

/// Which numbers: those of one object (or, with target and object 0, of the sensor as a whole) at one tick of one sensor.
struct Place {
    std::uint64_t sensor = 0, target = 0, tick = 0, object = 0;
};

class Draws {
public:
    Draws() = default;
    Draws(const plr_random& random, plr_key key) : random_(&random), key_(key) {}

    plr_key key(std::uint64_t stream, const Place& place) const {
        return random_->derive(random_->derive(key_, stream, place.sensor, place.target), 0, place.tick, place.object);
    }
    std::vector<double> normals(std::uint64_t stream, const Place& place, std::size_t first, std::size_t count) const {
        std::vector<double> out(count);
        random_->normal(key(stream, place), first, static_cast<std::int64_t>(count), out.data());
        return out;
    }
    double uniform(std::uint64_t stream, const Place& place, std::size_t index) const {
        double out = 0;
        random_->uniform(key(stream, place), index, 1, &out);
        return out;
    }

private:
    const plr_random* random_ = nullptr;
    plr_key key_{};
};

}  // namespace simulation
