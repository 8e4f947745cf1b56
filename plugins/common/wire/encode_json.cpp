#include <cmath>

#include <pelorus/space.hpp>

#include "encode.hpp"
#include "frame.hpp"
#include "text.hpp"

namespace wire {

namespace {

/// One object on one line, key by key.
class Line {
public:
    Line(const Envelope& envelope, std::uint64_t sequence, const char* kind) {
        text_ = "{\"pelorus\":";
        append_number(text_, std::int64_t{version});
        text("kind", kind).text("sender", envelope.sender.c_str());
        number("session", envelope.session).number("sequence", sequence);
    }

    Line& text(const char* key, const char* value) {
        name(key);
        string(value);
        return *this;
    }
    template <class Number> Line& number(const char* key, Number value) {
        name(key);
        append_number(text_, value);
        return *this;
    }
    /// A list with `entry(i)` for first ... last - 1, each of which appends a value.
    template <class Entry> Line& list(const char* key, std::int64_t first, std::int64_t last, Entry entry) {
        name(key);
        items(first, last, entry);
        return *this;
    }
    template <class Entry> void items(std::int64_t first, std::int64_t last, Entry entry) {
        text_ += '[';
        for (std::int64_t i = first; i < last; ++i) {
            if (i > first) text_ += ',';
            entry(i);
        }
        text_ += ']';
    }
    /// Where an entry of a list puts its value.
    template <class Number> void value(Number number) { append_number(text_, number); }
    void value(double number, const char* what, std::int64_t entry) {
        require_finite(number, what, entry);
        append_number(text_, number);
    }
    void string(const char* value) {
        text_ += '"';
        for (const char* c = value; *c != 0; ++c) {
            const auto byte = static_cast<unsigned char>(*c);
            if (*c == '"' || *c == '\\') text_ += '\\';
            if (byte < ' ') {
                text_ += "\\u00";
                text_ += "0123456789abcdef"[byte / 16];
                text_ += "0123456789abcdef"[byte % 16];
            } else {
                text_ += *c;
            }
        }
        text_ += '"';
    }

    void stamp(const Stamp& stamp, const Share& share) {
        number("time_ns", stamp.time).number("arrival_ns", stamp.arrival);
        if (share.parts == 1) return;
        const std::uint64_t part[] = {share.number, share.parts};
        list("part", 0, 2, [&](std::int64_t i) { value(part[i]); });
    }
    void space(const plr_space& raw, const char* frame) {
        const pelorus::Space space(raw);
        list("components", 0, space.size(), [&](std::int64_t i) { string(space[static_cast<int>(i)].name.c_str()); });
        if (*frame != 0) text("frame", frame);
    }
    /// Column vectors, one an entry.
    void vectors(const char* key, const plr_const_view& view, const Share& share) {
        list(key, share.first, share.last, [&](std::int64_t i) { vector(key, view, i); });
    }
    void vector(const char* key, const plr_const_view& view, std::int64_t i) {
        items(0, view.rows,
              [&](std::int64_t r) { value(view.data[i * view.item_stride + r * view.row_stride], key, i); });
    }
    void matrices(const char* key, const plr_const_view& view, const Share& share) {
        list(key, share.first, share.last, [&](std::int64_t i) { matrix(key, view, i); });
    }
    /// The matrix that all entries have.
    void matrix(const char* key, const plr_const_view& view) {
        name(key);
        matrix(key, view, 0);
    }
    void matrix(const char* key, const plr_const_view& view, std::int64_t i) {
        items(0, view.rows, [&](std::int64_t r) {
            items(0, view.cols, [&](std::int64_t c) {
                value(view.data[i * view.item_stride + r * view.row_stride + c * view.col_stride], key, i);
            });
        });
    }
    /// One number an entry; nothing where there are none.
    template <class Number> void column(const char* key, const Number* values, const Share& share) {
        if (values != nullptr) list(key, share.first, share.last, [&](std::int64_t i) { value(values[i]); });
    }
    void lists(const char* key, const std::int64_t* offsets, const std::uint64_t* ids, const Share& share) {
        if (offsets == nullptr) return;
        list(key, share.first, share.last,
             [&](std::int64_t i) { items(offsets[i], offsets[i + 1], [&](std::int64_t k) { value(ids[k]); }); });
    }

    std::string end() { return text_ + "}\n"; }

private:
    void name(const char* key) {
        text_ += ",\"";
        text_ += key;
        text_ += "\":";
    }
    std::string text_;
};

const char* status_word(std::int32_t status) {
    static const char* const words[] = {"tentative", "confirmed", "coasting", "deleted"};
    return words[status];  // the host lets no other value through
}

void write_uncertainty(Line& line, const plr_const_view& covariance, Uncertainty uncertainty, const Share& share) {
    if (uncertainty == Uncertainty::covariances) line.matrices("covariances", covariance, share);
    if (uncertainty != Uncertainty::deviations) return;
    line.list("deviations", share.first, share.last, [&](std::int64_t i) {
        line.items(0, covariance.rows, [&](std::int64_t r) {
            const double variance =
                covariance.data[i * covariance.item_stride + r * covariance.row_stride + r * covariance.col_stride];
            line.value(std::sqrt(variance), "deviations", i);
        });
    });
}

}  // namespace

Datagrams json_scan(Envelope& envelope, Stamp stamp, const plr_scan& scan, std::size_t maximum) {
    const auto write = [&](const Share& share, std::uint64_t sequence) {
        Line line(envelope, sequence, "scan");
        line.stamp(stamp, share);
        line.text("sensor", scan.sensor);
        line.space(*scan.space, scan.frame);
        line.vectors("measurements", scan.measurements, share);
        const bool common = scan.covariances.data != nullptr && scan.covariances.item_stride == 0;
        if (common && scan.measurements.count > 0) {
            line.matrix("covariance", scan.covariances);
        } else if (scan.covariances.data != nullptr) {
            line.matrices("covariances", scan.covariances, share);
        }
        line.column("ids", scan.ids, share);
        line.column("times_ns", scan.times, share);
        if (scan.snr.data != nullptr)
            line.list("snr", share.first, share.last,
                      [&](std::int64_t i) { line.value(scan.snr.data[i * scan.snr.item_stride], "snr", i); });
        if (scan.waveform.data != nullptr)
            line.list("waveform", 0, scan.waveform.rows, [&](std::int64_t r) {
                line.value(scan.waveform.data[r * scan.waveform.row_stride], "waveform", r);
            });
        return line.end();
    };
    return deal(envelope, scan.measurements.count, maximum, write);
}

Datagrams json_truth(Envelope& envelope, Stamp stamp, const plr_truth& truth, std::size_t maximum) {
    const auto write = [&](const Share& share, std::uint64_t sequence) {
        Line line(envelope, sequence, "truth");
        line.stamp(stamp, share);
        line.space(*truth.space, truth.frame);
        line.column("ids", truth.ids, share);
        line.column("times_ns", truth.times, share);
        line.vectors("states", truth.state, share);
        if (truth.extent.data != nullptr) line.matrices("extents", truth.extent, share);
        line.column("parents", truth.parents, share);
        line.column("births_ns", truth.births, share);
        line.lists("measurements", truth.measurement_offsets, truth.measurements, share);
        return line.end();
    };
    return deal(envelope, truth.count, maximum, write);
}

Datagrams json_tracks(Envelope& envelope, Stamp stamp, const plr_tracks& tracks, Uncertainty uncertainty,
                      std::size_t maximum) {
    const auto write = [&](const Share& share, std::uint64_t sequence) {
        Line line(envelope, sequence, "tracks");
        line.stamp(stamp, share);
        line.space(*tracks.space, tracks.frame);
        line.column("ids", tracks.ids, share);
        line.column("times_ns", tracks.times, share);
        line.list("status", share.first, share.last,
                  [&](std::int64_t i) { line.string(status_word(tracks.status[i])); });
        line.list("misses", share.first, share.last,
                  [&](std::int64_t i) { line.value(std::int64_t{tracks.misses[i]}); });
        line.vectors("means", tracks.mean, share);
        write_uncertainty(line, tracks.covariance, uncertainty, share);
        if (tracks.extent.data != nullptr) line.matrices("extents", tracks.extent, share);
        line.lists("parents", tracks.parent_offsets, tracks.parents, share);
        line.column("groups", tracks.groups, share);
        line.lists("measurements", tracks.measurement_offsets, tracks.measurements, share);
        return line.end();
    };
    return deal(envelope, tracks.count, maximum, write);
}

std::string json_end(Envelope& envelope) { return Line(envelope, envelope.sequence++, "end").end(); }

}  // namespace wire
