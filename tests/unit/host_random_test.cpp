#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <vector>

#include "host/philox.hpp"
#include "host/services.hpp"

using namespace pelorus::host;

namespace {

const plr_random& random_numbers = random_service();

std::vector<double> uniforms(plr_key key, std::int64_t count) {
    std::vector<double> out(static_cast<std::size_t>(count));
    random_numbers.uniform(key, 0, count, out.data());
    return out;
}

std::vector<double> normals(plr_key key, std::int64_t count) {
    std::vector<double> out(static_cast<std::size_t>(count));
    random_numbers.normal(key, 0, count, out.data());
    return out;
}

double moment(const std::vector<double>& values, int order) {
    double sum = 0;
    for (const double value : values) sum += std::pow(value, order);
    return sum / static_cast<double>(values.size());
}

/// Kolmogorov's distance between the sample and a distribution function, times sqrt(n): above 1.95 once in a thousand samples.
template <class Distribution> double kolmogorov(std::vector<double> sample, Distribution&& distribution) {
    std::sort(sample.begin(), sample.end());
    const auto n = static_cast<double>(sample.size());
    double distance = 0;
    for (std::size_t i = 0; i < sample.size(); ++i) {
        const double expected = distribution(sample[i]);
        distance =
            std::max({distance, static_cast<double>(i + 1) / n - expected, expected - static_cast<double>(i) / n});
    }
    return distance * std::sqrt(n);
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum / static_cast<double>(a.size());
}

bool same(plr_key a, plr_key b) { return a.word[0] == b.word[0] && a.word[1] == b.word[1]; }

}  // namespace

TEST_CASE("Philox gives the known answers of its authors", "[host]") {
    // philox4x32 10 of Random123's kat_vectors.
    CHECK(philox({0, 0, 0, 0}, {0, 0}) == PhiloxBlock{0x6627e8d5u, 0xe169c58du, 0xbc57ac4cu, 0x9b00dbd8u});
    CHECK(philox({~0u, ~0u, ~0u, ~0u}, {~0u, ~0u}) == PhiloxBlock{0x408f276du, 0x41c83b0eu, 0xa20bc7c6u, 0x6d5451fdu});
    CHECK(philox({0x243f6a88u, 0x85a308d3u, 0x13198a2eu, 0x03707344u}, {0xa4093822u, 0x299f31d0u}) ==
          PhiloxBlock{0xd16cfe09u, 0x94fdccebu, 0x5001e420u, 0x24126ea1u});
}

TEST_CASE("The stream of a key is Philox at (block, upper word) under the lower word", "[host]") {
    const plr_key key{{0x299f31d0a4093822u, 0x0370734413198a2eu}};
    const PhiloxBlock first = philox({0, 0, 0x13198a2eu, 0x03707344u}, {0xa4093822u, 0x299f31d0u});
    const auto unit = [](std::uint32_t low, std::uint32_t high) {
        const std::uint64_t bits = std::uint64_t{high} << 32 | low;
        return std::ldexp(static_cast<double>(bits >> 12) + 0.5, -52);
    };
    const std::vector<double> u = uniforms(key, 2);
    CHECK(u[0] == unit(first[0], first[1]));
    CHECK(u[1] == unit(first[2], first[3]));
    const PhiloxBlock far = philox({0x89abcdefu, 0x01234567u, 0x13198a2eu, 0x03707344u}, {0xa4093822u, 0x299f31d0u});
    double number = 0;
    random_numbers.uniform(key, 2 * 0x0123456789abcdefu + 1, 1, &number);
    CHECK(number == unit(far[2], far[3]));
}

TEST_CASE("Normals are Box-Muller of the uniforms of the same numbers", "[host]") {
    const plr_key key{{3, 4}};
    const std::vector<double> u = uniforms(key, 200), z = normals(key, 200);
    for (std::size_t j = 0; j < 200; j += 2) {
        const double radius = std::sqrt(-2 * std::log(u[j]));
        REQUIRE(z[j] == Approx(radius * std::cos(2 * M_PI * u[j + 1])).margin(1e-15));
        REQUIRE(z[j + 1] == Approx(radius * std::sin(2 * M_PI * u[j + 1])).margin(1e-15));
    }
}

TEST_CASE("A number does not depend on which others are drawn with it", "[host]") {
    const plr_key key{{11, 12}};
    const std::vector<double> u = uniforms(key, 64), z = normals(key, 64);
    for (std::uint64_t first = 0; first < 64; ++first)
        for (std::int64_t count = 0; count <= 64 - static_cast<std::int64_t>(first); ++count) {
            std::vector<double> part(static_cast<std::size_t>(count) + 1, -7.0);
            random_numbers.uniform(key, first, count, part.data());
            REQUIRE(std::equal(part.begin(), part.end() - 1, u.begin() + static_cast<std::ptrdiff_t>(first)));
            random_numbers.normal(key, first, count, part.data());
            REQUIRE(std::equal(part.begin(), part.end() - 1, z.begin() + static_cast<std::ptrdiff_t>(first)));
            REQUIRE(part.back() == -7.0);  // nothing beyond count is written
        }
}

TEST_CASE("Uniform numbers fill the open unit interval evenly", "[host]") {
    const std::vector<double> u = uniforms({{1, 2}}, 1000000);
    CHECK(*std::min_element(u.begin(), u.end()) > 0.0);
    CHECK(*std::max_element(u.begin(), u.end()) < 1.0);
    CHECK(moment(u, 1) == Approx(0.5).margin(4 * std::sqrt(1.0 / 12 / 1e6)));
    CHECK(moment(u, 2) == Approx(1.0 / 3).margin(4 * std::sqrt(4.0 / 45 / 1e6)));
    CHECK(kolmogorov(u, [](double x) { return x; }) < 1.95);
}

TEST_CASE("Normal numbers have the normal distribution and moments", "[host]") {
    const std::vector<double> z = normals({{1, 2}}, 1000000);
    // The variances of the sample moments of order 1 to 4 are 1, 2, 15 and 96 over n.
    CHECK(moment(z, 1) == Approx(0).margin(4e-3));
    CHECK(moment(z, 2) == Approx(1).margin(4e-3 * std::sqrt(2.0)));
    CHECK(moment(z, 3) == Approx(0).margin(4e-3 * std::sqrt(15.0)));
    CHECK(moment(z, 4) == Approx(3).margin(4e-3 * std::sqrt(96.0)));
    CHECK(kolmogorov(z, [](double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }) < 1.95);
    // The two of a pair, and neighbours, know nothing of each other.
    std::vector<double> even, odd;
    for (std::size_t i = 0; i < z.size(); i += 2) {
        even.push_back(z[i]);
        odd.push_back(z[i + 1]);
    }
    CHECK(std::abs(correlation(even, odd)) < 4 / std::sqrt(5e5));
}

TEST_CASE("Derived keys differ over a grid of a million", "[host]") {
    const plr_key parent{{7, 0}};
    std::vector<std::array<std::uint64_t, 2>> keys;
    std::vector<std::uint64_t> lower_words;
    for (std::uint64_t stream = 0; stream < 10; ++stream)
        for (std::uint64_t step = 0; step < 100; ++step)
            for (std::uint64_t item = 0; item < 1000; ++item) {
                const plr_key key = random_numbers.derive(parent, stream, step, item);
                keys.push_back({key.word[0], key.word[1]});
                lower_words.push_back(key.word[0]);
            }
    std::sort(keys.begin(), keys.end());
    CHECK(std::adjacent_find(keys.begin(), keys.end()) == keys.end());
    // Each half alone is as good as random: a million of 2^64 should not meet either.
    std::sort(lower_words.begin(), lower_words.end());
    CHECK(std::adjacent_find(lower_words.begin(), lower_words.end()) == lower_words.end());
}

TEST_CASE("Siblings, parents and children are independent streams", "[host]") {
    const plr_key parent = node_key(7, 0, "world");
    const std::int64_t n = 100000;
    const double bound = 4.5 / std::sqrt(static_cast<double>(n));
    std::vector<std::vector<double>> streams = {normals(parent, n)};
    for (const auto& [stream, step, item] :
         {std::array<std::uint64_t, 3>{1, 0, 0}, {1, 0, 1}, {1, 1, 0}, {2, 0, 0}, {1, 2, 0}})
        streams.push_back(normals(random_numbers.derive(parent, stream, step, item), n));
    for (std::size_t i = 0; i < streams.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) CHECK(std::abs(correlation(streams[i], streams[j])) < bound);
    // One number of each of many items is a sample as good as many numbers of one.
    std::vector<double> across(static_cast<std::size_t>(n));
    for (std::size_t item = 0; item < across.size(); ++item)
        random_numbers.normal(random_numbers.derive(parent, PLR_STREAM_NOISE, 3, item), 0, 1, &across[item]);
    CHECK(kolmogorov(across, [](double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }) < 1.95);
    double neighbours = 0;
    for (std::size_t item = 1; item < across.size(); ++item) neighbours += across[item] * across[item - 1];
    CHECK(std::abs(neighbours) / static_cast<double>(n) < bound);
}

TEST_CASE("The key of a node depends on seed, run and every letter of its name", "[host]") {
    const plr_key key = node_key(7, 0, "world");
    CHECK(same(key, node_key(7, 0, "world")));
    const plr_key others[] = {node_key(8, 0, "world"),      node_key(7, 1, "world"),
                              node_key(0, 7, "world"),      node_key(7, 0, "worle"),
                              node_key(7, 0, "worl"),       node_key(7, 0, ""),
                              node_key(7, 0, "xorld"),      node_key(7, 0, std::string("world\0", 6)),
                              node_key(7, 0, "worldworld"), node_key(7, 0, "worldworldworld")};
    std::set<std::array<std::uint64_t, 2>> distinct;
    for (const plr_key& other : others) distinct.insert({other.word[0], other.word[1]});
    CHECK(distinct.size() == std::size(others));
    CHECK(distinct.count({key.word[0], key.word[1]}) == 0);
}
