#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>
#include <limits>

#include <pelorus/abi/consistency.h>

#include "runtime/message_bytes.hpp"
#include "runtime/message_check.hpp"
#include "runtime/message_copy.hpp"
#include "runtime_fakes.hpp"

using namespace fakes;
namespace rt = pelorus::runtime;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

std::string problem(const plr_message& message) {
    rt::CheckMemory memory;
    try {
        rt::check_message(message, memory);
        return {};
    } catch (const rt::BadMessage& bad) {
        return bad.what();
    }
}

/// Three tracks in two dimensions with everything that a track can have.
struct Tracks {
    Tracks() {
        body.struct_size = sizeof body;
        body.record_version = 3;
        body.count = 3;
        body.frame = "ship";
        body.space = &space;
        body.ids = ids;
        body.times = times;
        body.status = status;
        body.misses = misses;
        body.mean = view(mean, 2, 1, 3);
        body.covariance = view(covariance, 2, 2, 3);
        body.extent = view(covariance, 2, 2, 3);
        body.parent_offsets = parent_offsets;
        body.parents = parents;
        body.groups = ids;
        body.measurement_offsets = parent_offsets;
        body.measurements = parents;
        body.records = view(mean, 2, 1, 3);
        body.record_of = "estimator.kalman";
        body.measurement_distances = mean;
        body.measurement_weights = mean;
    }
    Tracks(const Tracks&) = delete;
    Tracks& operator=(const Tracks&) = delete;
    plr_message message() const {
        plr_message out{};
        out.struct_size = sizeof out;
        out.kind = PLR_MESSAGE_TRACKS;
        out.time = 5, out.arrival = 6;
        out.body.tracks = &body;
        return out;
    }
    std::uint64_t ids[3] = {7, 8, 9}, parents[3] = {1, 2, 3};
    std::int64_t times[3] = {1, 1, 1}, parent_offsets[4] = {0, 0, 1, 3};
    std::int32_t status[3] = {0, 1, 2}, misses[3] = {0, 0, 4};
    double mean[6] = {1, 2, 3, 4, 5, 6};
    double covariance[12] = {1, 0, 0, 1, 2, 0, 0, 2, 3, 0.5, 0.5, 3};
    plr_space space = position_space(2);
    plr_tracks body{};
};

/// Bytes of a message: equal bytes, equal messages.
std::vector<unsigned char> bytes_of(const plr_message& message) {
    rt::ByteWriter writer;
    rt::write_message(writer, message);
    return writer.bytes();
}

}  // namespace

TEST_CASE("well-formed messages of every kind pass", "[runtime][message]") {
    CHECK(problem(Scan({1, 2, 3}).message(0)).empty());
    CHECK(problem(Scan({}).message(0)).empty());
    CHECK(problem(Command(1).message(0)).empty());
    CHECK(problem(Table("by_time", {0, 1, 1, not_a_number}).message(0)).empty());
    Tracks tracks;
    CHECK(problem(tracks.message()).empty());
    tracks.body = plr_tracks{};  // no tracks: no arrays
    tracks.body.struct_size = sizeof tracks.body;
    tracks.body.frame = "";
    tracks.body.space = &tracks.space;
    CHECK(problem(tracks.message()).empty());
}

TEST_CASE("what is wrong with a scan is told by field and entry", "[runtime][message]") {
    const auto expect = [](const auto& spoil, const std::string& line) {
        Scan scan({1, 2, 3});
        spoil(scan);
        CHECK(problem(scan.message(0)) == line);
    };
    const plr_space empty{sizeof(plr_space), 0, nullptr}, plane = position_space(2);
    plr_component unnamed[1] = {{sizeof(plr_component), 0, "", "m", 0, 1}};
    const plr_space blank{sizeof(plr_space), 1, unnamed};
    const std::int64_t huge = std::int64_t{1} << 40;
    expect([&](Scan& scan) { scan.body.struct_size = 100; }, "scan.struct_size is 100, expected at least 280");
    expect([&](Scan& scan) { scan.body.struct_size = 285; }, "scan.struct_size is 285, expected a multiple of 8");
    expect([&](Scan& scan) { scan.body.sensor = nullptr; }, "scan.sensor is NULL, expected a string");
    expect([&](Scan& scan) { scan.body.frame = nullptr; }, "scan.frame is NULL, expected a string");
    expect([&](Scan& scan) { scan.body.space = nullptr; }, "scan.space is NULL");
    expect([&](Scan& scan) { scan.body.space = &empty; }, "scan.space has no components");
    expect([&](Scan& scan) { scan.body.space = &blank; }, "scan.space.components[0].name is empty");
    expect([&](Scan& scan) { scan.body.space = &plane; }, "scan.measurements is 1 x 1 x 3, expected 2 x 1 x 3");
    expect([&](Scan& scan) { scan.body.measurements.data = nullptr; }, "scan.measurements is NULL");
    expect([&](Scan& scan) { scan.body.measurements.count = -1; },
           "scan.measurements.count is -1, expected 0 to 17179869184");
    expect([&](Scan& scan) { scan.body.measurements.count = huge; },
           "scan.measurements.count is 1099511627776, expected 0 to 17179869184");
    expect([&](Scan& scan) { scan.body.covariances.count = 2; }, "scan.covariances is 1 x 1 x 2, expected 1 x 1 x 3");
    expect([&](Scan& scan) { scan.body.ids = nullptr; }, "scan.ids is NULL, expected 3 entries");
    expect([&](Scan& scan) { scan.ids[2] = 0; }, "scan.ids[2] is 0, as entry 0 is");
    expect([&](Scan& scan) { scan.values[1] = not_a_number; },
           "scan.measurements[1] has nan at (0, 0), expected finite numbers");
    expect([&](Scan& scan) { scan.variances[2] = INFINITY; },
           "scan.covariances[2] has inf at (0, 0), expected finite numbers");
    expect([&](Scan& scan) { scan.body.snr = view(scan.values.data(), 1, 1, 2); },
           "scan.snr is 1 x 1 x 2, expected 1 x 1 x 3");
    expect([&](Scan& scan) { scan.body.waveform = view(scan.values.data(), 1, 1, 1); },
           "scan.waveform is 1 x 1 x 1, expected 0 x 1 x 1");
}

TEST_CASE("what is wrong with tracks is told by field and entry", "[runtime][message]") {
    const auto expect = [](const auto& spoil, const std::string& line) {
        Tracks tracks;
        spoil(tracks);
        CHECK(problem(tracks.message()) == line);
    };
    expect([&](Tracks& tracks) { tracks.ids[2] = 7; }, "tracks.ids[2] is 7, as entry 0 is, at the same time");
    expect([&](Tracks& tracks) { tracks.status[1] = 4; },
           "tracks.status[1] is 4, expected one of PLR_TRACK_... (0 to 3)");
    expect([&](Tracks& tracks) { tracks.misses[0] = -1; }, "tracks.misses[0] is -1, expected 0 or more");
    expect([&](Tracks& tracks) { tracks.mean[3] = not_a_number; },
           "tracks.mean[1] has nan at (1, 0), expected finite numbers");
    expect([&](Tracks& tracks) { tracks.covariance[9] = -INFINITY; },
           "tracks.covariance[2] has -inf at (1, 0), expected finite numbers");
    expect([&](Tracks& tracks) { tracks.body.covariance.rows = 3; },
           "tracks.covariance is 3 x 2 x 3, expected 2 x 2 x 3");
    expect([&](Tracks& tracks) { tracks.body.extent.rows = 1; },
           "tracks.extent is 1 x 2, expected 1 x 1, 2 x 2 or 3 x 3");
    expect([&](Tracks& tracks) { tracks.parent_offsets[0] = 1; }, "tracks.parent_offsets[0] begins with 1, expected 0");
    expect([&](Tracks& tracks) { tracks.parent_offsets[3] = 0; },
           "tracks.parent_offsets[3] falls from 1 to 0, expected an ascending list");
    expect([&](Tracks& tracks) { tracks.body.parents = nullptr; }, "tracks.parents is NULL, expected 3 entries");
    expect([&](Tracks& tracks) { tracks.body.records.count = 2; }, "tracks.records is 2 x 1 x 2, expected any x 1 x 3");
    expect([&](Tracks& tracks) { tracks.body.times = nullptr; }, "tracks.times is NULL, expected 3 entries");
}

TEST_CASE("one track may be told at several times", "[runtime][message]") {
    Tracks tracks;
    tracks.ids[0] = tracks.ids[1] = 7;
    tracks.times[1] = 2;
    CHECK(problem(tracks.message()).empty());
}

TEST_CASE("what is wrong with values and tables is told by element", "[runtime][message]") {
    Command command(1);
    Table table("by_time", {0, 1, 2, 3});
    const char* texts[] = {"near", "far"};
    const char* holes[] = {"near", nullptr};
    SECTION("values") {
        command.number = not_a_number;
        CHECK(problem(command.message(0)) ==
              "values.quantities[0].numbers[0] has nan at (0, 0), expected finite numbers");
        command.number = 1;
        command.quantity.valid_from = 5, command.quantity.valid_to = 4;
        CHECK(problem(command.message(0)) == "values.quantities[0].valid_from is 5, after valid_to 4");
        command.quantity.name = nullptr;
        CHECK(problem(command.message(0)) == "values.quantities[0].name is NULL, expected a string");
    }
    SECTION("items without ids") {
        const double numbers[2] = {1, 2};
        command.quantity.numbers = view(numbers, 1, 1, 2);
        CHECK(problem(command.message(0)) ==
              "values.quantities[0].numbers has 2 items, expected 1 where there are no ids");
        const std::uint64_t ids[2] = {4, 5};
        command.quantity.ids = ids;
        CHECK(problem(command.message(0)).empty());
    }
    SECTION("columns") {
        table.columns[1].name = "time";
        CHECK(problem(table.message(0)) == "table.columns[1] has the name time twice");
        table.columns[1].reduce = 10;
        CHECK(problem(table.message(0)) == "table.columns[1].reduce is 10, expected one of PLR_REDUCE_... (0 to 9)");
    }
    SECTION("text columns") {
        table.columns[1].texts = texts;
        table.columns[1].text_count = 2;
        table.scalar.column = nullptr;
        CHECK(problem(table.message(0)) ==
              "table.rows[1] has 3 in text column error, expected an index into its 2 texts");
        table.rows[3] = 0;
        CHECK(problem(table.message(0)).empty());
        table.columns[1].texts = holes;
        CHECK(problem(table.message(0)) == "table.columns[1].texts[1] is NULL, expected a string");
    }
    SECTION("scalars") {
        table.scalar.column = "distance";
        CHECK(problem(table.message(0)) ==
              "table.scalars[0] names the column distance, which is not a numeric column of the table");
        table.scalar.column = nullptr;
        table.scalar.reduce = PLR_REDUCE_QUANTILE;
        table.scalar.quantile = 2;
        CHECK(problem(table.message(0)) == "table.scalars[0].quantile is 2, expected 0 to 1");
        table.scalar.reduce = PLR_REDUCE_CHI_SQUARE;
        table.scalar.quantile = 1;
        CHECK(problem(table.message(0)) == "table.scalars[0].quantile is 1, expected more than 0 and less than 1");
    }
    SECTION("kinds") {
        plr_message message = table.message(0);
        message.kind = 6;
        CHECK(problem(message) == "message.kind is 6, expected one of PLR_MESSAGE_... (1 to 5)");
        message.kind = PLR_MESSAGE_SCAN;
        message.body.scan = nullptr;
        CHECK(problem(message) == "scan is NULL");
        message.struct_size = 8;
        CHECK(problem(message) == "message.struct_size is 8, expected at least 56");
    }
}

TEST_CASE("a copy owns all that it points to and is packed", "[runtime][message]") {
    rt::MessagePool pool;
    rt::MessageRef copy;
    {
        Tracks tracks;
        // Structure-of-arrays: component by component.
        const double by_component[6] = {1, 3, 5, 2, 4, 6};
        tracks.body.mean = {by_component, 2, 1, 3, 3, 6, 1};
        copy = rt::copy_message(pool, tracks.message());
        Tracks same;
        CHECK(bytes_of(*copy) == bytes_of(*rt::copy_message(pool, same.message())));
        std::memset(static_cast<void*>(tracks.mean), 0, sizeof tracks.mean);
        std::memset(static_cast<void*>(tracks.ids), 0, sizeof tracks.ids);
    }
    const plr_tracks& tracks = *copy->body.tracks;
    CHECK(copy->time == 5);
    CHECK(tracks.mean.row_stride == 1);
    CHECK(tracks.mean.item_stride == 2);
    for (int i = 0; i < 6; ++i) CHECK(tracks.mean.data[i] == i + 1);
    CHECK(tracks.ids[2] == 9);
    CHECK(tracks.parents[2] == 3);
    CHECK(std::string(tracks.frame) == "ship");
    CHECK(std::string(tracks.record_of) == "estimator.kalman");
    CHECK(std::string(tracks.space->components[1].name) == "position.y");
    CHECK(reinterpret_cast<std::uintptr_t>(tracks.mean.data) % 16 == 0);
}

TEST_CASE("a covariance that is common to a scan stays one matrix, other common views are written out",
          "[runtime][message]") {
    rt::MessagePool pool;
    Scan scan({1, 2, 3});
    scan.body.covariances.item_stride = 0;
    scan.body.snr = view(scan.values.data(), 1, 1, 3);
    scan.body.snr.item_stride = 0;
    const rt::MessageRef copy = rt::copy_message(pool, scan.message(0));
    CHECK(copy->body.scan->covariances.item_stride == 0);
    CHECK(copy->body.scan->covariances.count == 3);
    CHECK(copy->body.scan->snr.item_stride == 1);
    CHECK(copy->body.scan->snr.data[2] == 1);
}

TEST_CASE("covariances of their own stay with their measurements", "[runtime][message]") {
    rt::MessagePool pool;
    Scan scan({1, 2, 3});
    scan.variances = {4, 5, 6};
    scan.body.covariances.data = scan.variances.data();
    const rt::MessageRef copy = rt::copy_message(pool, scan.message(0));
    REQUIRE(copy->body.scan->covariances.item_stride == 1);
    for (int i = 0; i < 3; ++i) CHECK(copy->body.scan->covariances.data[i] == 4 + i);
}

TEST_CASE("structs of a later ABI are read up to what is known", "[runtime][message]") {
    struct LargerComponent {
        plr_component known;
        double news;
    };
    LargerComponent components[2] = {{{sizeof(LargerComponent), 0, "position.x", "m", 0, 1}, 1},
                                     {{sizeof(LargerComponent), 0, "position.y", "m", 0, 2}, 2}};
    Tracks tracks;
    tracks.space.components = &components[0].known;
    CHECK(problem(tracks.message()).empty());
    rt::MessagePool pool;
    const rt::MessageRef copy = rt::copy_message(pool, tracks.message());
    const plr_space& space = *copy->body.tracks->space;
    CHECK(space.components[1].struct_size == sizeof(plr_component));
    CHECK(std::string(space.components[1].name) == "position.y");
    CHECK(space.components[1].prior_deviation == 2);
}

TEST_CASE("blocks are recycled: a steady stream of messages allocates once", "[runtime][message]") {
    rt::MessagePool pool;
    const Scan scan(std::vector<double>(100, 1.0));
    for (int i = 0; i < 50; ++i) {
        const rt::MessageRef first = rt::copy_message(pool, scan.message(i));
        const rt::MessageRef second_share = first;
        const rt::MessageRef other = rt::copy_message(pool, scan.message(-i));
        CHECK(second_share->time == i);
    }
    CHECK(pool.allocated() == 2);
}

TEST_CASE("a message goes to bytes and back unchanged", "[runtime][message]") {
    rt::MessagePool pool;
    const char* texts[] = {"near", "far"};
    Table table("by_time", {0, 1, 1, 0});
    table.columns[1].texts = texts;
    table.columns[1].text_count = 2;
    table.scalar.column = nullptr;
    Scan scan({1, 2, 3});
    scan.body.covariances.item_stride = 0;
    const Scan nothing({});
    const Tracks tracks;
    const Command command(4);
    for (const plr_message& message :
         {table.message(1), scan.message(2, 3), nothing.message(4), tracks.message(), command.message(-1)}) {
        CAPTURE(message.kind);
        const std::vector<unsigned char> bytes = bytes_of(*rt::copy_message(pool, message));
        rt::ByteReader reader(bytes.data(), bytes.size());
        const rt::MessageRef back = rt::read_message(reader, pool);
        CHECK(reader.left() == 0);
        CHECK(bytes_of(*back) == bytes);
        CHECK(back->time == message.time);
        for (std::size_t size = 0; size < bytes.size(); ++size) {
            rt::ByteReader cut(bytes.data(), size);
            CHECK_THROWS_AS(rt::read_message(cut, pool), rt::CorruptBytes);
        }
    }
}
