#include "campaign/rank_messages.hpp"

#include <utility>

namespace pelorus::campaign {

namespace {

using runtime::ByteReader;
using runtime::ByteWriter;

void write_unit(ByteWriter& writer, const Unit& unit) {
    writer.number(std::uint64_t{unit.cell});
    writer.number(unit.block);
}

Unit read_unit(ByteReader& reader) {
    Unit unit;
    unit.cell = static_cast<std::size_t>(reader.number<std::uint64_t>());
    unit.block = reader.number<std::uint64_t>();
    return unit;
}

void write_computed(ByteWriter& writer, const Computed& computed) {
    write_unit(writer, computed.unit);
    writer.number(std::uint8_t{computed.is_complete});
    computed.totals.write(writer);
    writer.number(std::uint8_t{computed.failure.has_value()});
    if (computed.failure) {
        writer.number(computed.failure->run);
        writer.text(computed.failure->message);
    }
    writer.number(std::uint64_t{computed.timings.size()});
    for (const runtime::NodeTiming& timing : computed.timings) {
        writer.text(timing.node);
        writer.number(timing.calls);
        writer.number(timing.seconds);
        writer.number(timing.longest_seconds);
    }
}

Computed read_computed(ByteReader& reader) {
    Computed computed;
    computed.unit = read_unit(reader);
    computed.is_complete = reader.flag();
    computed.totals = Totals::read(reader);
    if (reader.flag()) {
        computed.failure = Failure{computed.unit.cell, reader.number<std::uint64_t>(), {}};
        computed.failure->message = reader.text();
    }
    computed.timings.resize(reader.count(32));
    for (runtime::NodeTiming& timing : computed.timings) {
        timing.node = reader.text();
        timing.calls = reader.number<std::uint64_t>();
        timing.seconds = reader.number<double>();
        timing.longest_seconds = reader.number<double>();
    }
    return computed;
}

}  // namespace

Ranks::Bytes report_bytes(const RankReport& report) {
    ByteWriter writer;
    writer.text(report.identity);
    writer.number(report.wanted);
    writer.number(std::uint64_t{report.computed.size()});
    for (const Computed& computed : report.computed) write_computed(writer, computed);
    return std::move(writer.bytes());
}

RankReport report_from(const Ranks::Bytes& bytes) {
    ByteReader reader(bytes.data(), bytes.size());
    RankReport report;
    report.identity = reader.text();
    report.wanted = reader.number<std::uint32_t>();
    for (std::size_t left = reader.count(18); left > 0; --left) report.computed.push_back(read_computed(reader));
    return report;
}

Ranks::Bytes order_bytes(const RankOrder& order) {
    ByteWriter writer;
    writer.number(std::uint8_t{order.is_last});
    writer.number(std::uint64_t{order.units.size()});
    for (const Unit& unit : order.units) write_unit(writer, unit);
    return std::move(writer.bytes());
}

RankOrder order_from(const Ranks::Bytes& bytes) {
    ByteReader reader(bytes.data(), bytes.size());
    RankOrder order;
    order.is_last = reader.flag();
    order.units.resize(reader.count(16));
    for (Unit& unit : order.units) unit = read_unit(reader);
    return order;
}

}  // namespace pelorus::campaign
