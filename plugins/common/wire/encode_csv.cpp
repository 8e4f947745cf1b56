#include <pelorus/failure.hpp>
#include <pelorus/space.hpp>

#include "encode.hpp"
#include "frame.hpp"
#include "text.hpp"

namespace wire {

namespace {

/// Cells with commas between, quoted where needed.
class Table {
public:
    Table& text(const std::string& value) {
        separate();
        if (value.find_first_of(",\"\r\n") == std::string::npos) return text_ += value, *this;
        text_ += '"';
        for (const char c : value) text_ += c == '"' ? std::string("\"\"") : std::string(1, c);
        text_ += '"';
        return *this;
    }
    template <class Number> Table& number(Number value) { return separate(), append_number(text_, value), *this; }
    Table& empty(std::size_t cells) {
        for (; cells > 0; --cells) separate();
        return *this;
    }
    void end_row() {
        text_ += '\n';
        in_row_ = false;
    }
    std::string take() { return std::move(text_); }

private:
    void separate() {
        if (in_row_) text_ += ',';
        in_row_ = true;
    }
    std::string text_;
    bool in_row_ = false;
};

Table& begin(Table& table, const Envelope& envelope, std::uint64_t sequence, const char* kind) {
    return table.number(std::int64_t{version})
        .text(kind)
        .text(envelope.sender)
        .number(envelope.session)
        .number(sequence);
}

void write_header(Table& table, const plr_scan& scan, const pelorus::Space& space, bool parts) {
    for (const char* name : {"pelorus", "kind", "sender", "session", "sequence"}) table.text(name);
    if (parts) table.text("part").text("parts");
    for (const char* name : {"sensor", "time_ns", "arrival_ns", "id"}) table.text(name);
    for (const auto& component : space.components()) table.text(component.name);
    if (scan.covariances.data != nullptr)
        for (int r = 0; r < space.size(); ++r)
            for (int c = r; c < space.size(); ++c) table.text("covariance." + space[r].name + "." + space[c].name);
    if (scan.times != nullptr) table.text("measured_ns");
    if (scan.snr.data != nullptr) table.text("snr");
    table.end_row();
}

void write_measurement(Table& table, const plr_scan& scan, std::int64_t i) {
    const auto number = [&](double value, const char* what) {
        require_finite(value, what, i);
        table.number(value);
    };
    table.number(scan.ids[i]);
    for (std::int64_t r = 0; r < scan.measurements.rows; ++r)
        number(scan.measurements.data[i * scan.measurements.item_stride + r * scan.measurements.row_stride],
               "measurements");
    const plr_const_view& p = scan.covariances;
    if (p.data != nullptr)
        for (std::int64_t r = 0; r < p.rows; ++r)
            for (std::int64_t c = r; c < p.cols; ++c)
                number(p.data[i * p.item_stride + r * p.row_stride + c * p.col_stride], "covariances");
    if (scan.times != nullptr) table.number(scan.times[i]);
    if (scan.snr.data != nullptr) number(scan.snr.data[i * scan.snr.item_stride], "snr");
}

}  // namespace

Datagrams csv_scan(Envelope& envelope, Stamp stamp, const plr_scan& scan, std::size_t maximum) {
    if (scan.waveform.data != nullptr)
        throw pelorus::UnsupportedError("CSV frames have no column for a waveform; use format: json");
    const pelorus::Space space(*scan.space);
    const auto write = [&](const Share& share, std::uint64_t sequence) {
        Table table;
        write_header(table, scan, space, share.parts > 1);
        const auto start_row = [&] {
            begin(table, envelope, sequence, "scan");
            if (share.parts > 1) table.number(share.number).number(share.parts);
            table.text(scan.sensor).number(stamp.time).number(stamp.arrival);
        };
        for (std::int64_t i = share.first; i < share.last; ++i) {
            start_row();
            write_measurement(table, scan, i);
            table.end_row();
        }
        if (share.first == share.last) {  // a row without components: a scan with nothing in it
            start_row();
            const auto n = static_cast<std::size_t>(space.size());
            table.empty(1 + n + (scan.covariances.data != nullptr ? n * (n + 1) / 2 : 0) + (scan.times != nullptr) +
                        (scan.snr.data != nullptr));
            table.end_row();
        }
        return table.take();
    };
    return deal(envelope, scan.measurements.count, maximum, write);
}

std::string csv_end(Envelope& envelope) {
    Table table;
    for (const char* name : {"pelorus", "kind", "sender", "session", "sequence"}) table.text(name);
    table.end_row();
    begin(table, envelope, envelope.sequence++, "end").end_row();
    return table.take();
}

}  // namespace wire
