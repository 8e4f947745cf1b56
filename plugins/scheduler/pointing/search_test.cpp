// The search for a target that a narrow field does not cover, and the rules of lock and loss.
#include <cmath>
#include <random>

#include <catch2/catch.hpp>

#include "lock.hpp"
#include "search_pattern.hpp"

using namespace pointing_scheduler;
using pelorus::Matrix;

namespace {

Matrix<2> spread_of(double left, double up, double correlation = 0) {
    Matrix<2> out;
    out << left * left, correlation * left * up, correlation * left * up, up * up;
    return out;
}

bool is_seen(const Field& field, const std::vector<Place>& places, double left, double up) {
    for (const Place& place : places)
        if (std::fabs(left - place.at.left) <= field.width / 2 && std::fabs(up - place.at.up) <= field.height / 2)
            return true;
    return false;
}

constexpr sensing::Offset pitch{1e-3, 1e-3};

}  // namespace

TEST_CASE("search: a field that covers the place looks at its middle alone", "[pointing]") {
    const Field window = Field::of({8e-3, 6e-3}, false);
    CHECK(search_pattern(window, spread_of(1e-3, 0.9e-3), 3, 0).size() == 1);
    CHECK(search_pattern(window, spread_of(1.5e-3, 0.9e-3), 3, 0).size() > 1);  // 4.5 mrad to the side, of 4
    const Field cone = Field::of({8e-3}, false);
    CHECK(cone.width == Approx(8e-3 / std::sqrt(2.0)));
    CHECK(cone.height == cone.width);
}

TEST_CASE("search: the places cover the ellipse, likeliest first, and lie nowhere else", "[pointing]") {
    const Field field = Field::of({2e-3, 3e-3}, false);
    const Matrix<2> spread = spread_of(4e-3, 2e-3, 0.7), inverse = spread.inverse();
    const auto places = search_pattern(field, spread, 3, 0);
    const auto squared = [&](double left, double up) {
        const pelorus::Vector<2> e(left, up);
        return e.dot(inverse * e);
    };
    CHECK(places.front().at.left == 0);
    CHECK(places.front().at.up == 0);
    for (std::size_t k = 1; k < places.size(); ++k)
        CHECK(squared(places[k].at.left, places[k].at.up) >=
              squared(places[k - 1].at.left, places[k - 1].at.up) * (1 - 1e-9));
    std::mt19937 random(7);
    std::uniform_real_distribution<double> angle(0, 2 * std::acos(-1.0)), share(0, 1);
    const Matrix<2> root = spread.llt().matrixL();
    int seen = 0;
    for (int k = 0; k < 4000; ++k) {
        const double a = angle(random), r = 2.999 * std::sqrt(share(random));
        const pelorus::Vector<2> e = root * pelorus::Vector<2>(r * std::cos(a), r * std::sin(a));
        seen += is_seen(field, places, e(0), e(1));
    }
    CHECK(seen == 4000);
    // The ellipse of 3 deviations has pi 9 4e-3 2e-3 sqrt(1 - 0.7^2) rad^2; each field adds 0.64 of its own area.
    const double area = std::acos(-1.0) * 9 * 8e-6 * std::sqrt(1 - 0.49);
    CHECK(static_cast<double>(places.size()) > area / (6e-6 * 0.64));
    CHECK(static_cast<double>(places.size()) < 2 * area / (6e-6 * 0.64));
}

TEST_CASE("search: what was not found there is searched for in a wider area", "[pointing]") {
    const Field field = Field::of({2e-3, 2e-3}, false);
    std::size_t before = 0;
    for (const double widened : {0.0, 1e-3, 2e-3, 4e-3}) {
        const auto places = search_pattern(field, spread_of(1e-4, 1e-4), 3, widened);
        CHECK(is_seen(field, places, widened, 0));
        CHECK(is_seen(field, places, 0, -widened));
        CHECK(places.size() >= before);
        before = places.size();
    }
    CHECK(before > 9);
}

TEST_CASE("search: in the plane it goes left and right, and a hopeless one is bounded", "[pointing]") {
    const Field sector = Field::of({0.02}, true);
    Matrix<2> spread = Matrix<2>::Zero();
    spread(0, 0) = 0.01 * 0.01;
    const auto places = search_pattern(sector, spread, 3, 0);
    REQUIRE(places.size() == 5);  // 0, +-0.016, +-0.032: 0.042 is more than 0.03
    for (const auto& place : places) CHECK(place.at.up == 0);
    CHECK(std::fabs(places[1].at.left) == Approx(0.016));
    CHECK(search_pattern(Field::of({1e-4}, false), spread_of(1, 1), 3, 0).size() == most_fields);
}

TEST_CASE("lock: so many looks in a row make it, and so many others lose it", "[pointing]") {
    const Rules rules{3, 2, 1};
    Lock lock;
    lock.begin();
    const auto after = [&](std::initializer_list<bool> looks) {
        for (const bool hit : looks) {
            lock.look(rules, hit, true);
            lock.choose({{}}, pitch);
        }
        return lock.now;
    };
    CHECK(after({true, true}) == State::acquiring);
    CHECK(after({false, true, true}) == State::acquiring);
    CHECK(after({true}) == State::locked);
    CHECK(after({false}) == State::locked);
    CHECK(after({true, false}) == State::locked);
    CHECK(after({false}) == State::lost);
    CHECK(after({true, true}) == State::lost);  // not yet
    CHECK(after({true}) == State::locked);
}

TEST_CASE("lock: a search goes from place to place, each for its looks, and widens where it found nothing",
          "[pointing]") {
    const Rules rules{3, 4, 2};
    const std::vector<Place> pattern{{0, 0, {}}, {1, 0, {1e-3, 0}}, {-1, 0, {-1e-3, 0}}},
        otherwise{{0, 0, {}}, {-1, 0, {-1e-3, 0}}, {1, 0, {1e-3, 0}}};
    Lock lock;
    lock.begin();
    REQUIRE(lock.choose(pattern, pitch));
    CHECK(lock.now == State::searching);
    std::vector<std::int32_t> columns;
    for (int k = 0; k < 6; ++k) {
        columns.push_back(lock.place.column);
        lock.look(rules, false, true);
        CHECK(lock.choose(k < 3 ? pattern : otherwise, pitch) == (k < 5));  // another order makes it forget nothing
    }
    CHECK(columns == std::vector<std::int32_t>{0, 0, 1, 1, -1, -1});
    CHECK(lock.passes == 1);
    REQUIRE(lock.choose(pattern, pitch));
    CHECK(lock.place.column == 0);
    lock.look(rules, false, false);  // on its way there: does not count
    CHECK(lock.looks_there == 0);
    lock.look(rules, true, true);
    CHECK(lock.passes == 0);
    REQUIRE(lock.choose({{}}, pitch));
    CHECK(lock.now == State::acquiring);
    for (int k = 0; k < 4; ++k) {
        lock.look(rules, false, true);  // the only place: as long as until a loss
        CHECK(lock.choose({{}}, pitch) == (k < 3));
    }
    CHECK(lock.passes == 1);
}

TEST_CASE("lock: what was looked at stays where it is in the sky while the prediction moves", "[pointing]") {
    const Rules rules{3, 4, 1};
    const std::vector<Place> pattern{{0, 0, {}}, {1, 0, {1e-3, 0}}, {-1, 0, {-1e-3, 0}}, {2, 0, {2e-3, 0}}};
    Lock lock;
    lock.begin();
    REQUIRE(lock.choose(pattern, pitch));
    lock.look(rules, false, true);
    lock.shift({1.1e-3, 0});  // what was the middle is now the place of column -1
    REQUIRE(lock.choose(pattern, pitch));
    CHECK(lock.place.column == 0);
    lock.look(rules, false, true);
    REQUIRE(lock.choose(pattern, pitch));
    CHECK(lock.place.column == 1);
    lock.look(rules, false, true);
    REQUIRE(lock.choose(pattern, pitch));
    CHECK(lock.place.column == 2);
}
