#include "decode.hpp"

#include <cmath>

#include "text.hpp"

namespace wire {

void decode(std::string_view bytes, const Vocabulary& vocabulary, Datagram& into) {
    into = Datagram();
    const std::size_t first = bytes.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos) throw BadFrame("is empty, expected JSON lines or CSV");
    if (bytes.size() > largest_datagram)
        throw BadFrame("has " + std::to_string(bytes.size()) + " bytes, expected at most " +
                       std::to_string(largest_datagram));
    try {
        if (bytes[first] == '{')
            decode_json(bytes, vocabulary, into);
        else
            decode_csv(bytes, vocabulary, into);
    } catch (...) {
        into.frames.clear();
        throw;
    }
}

const Vocabulary::Sensor& sensor_of(const Vocabulary& vocabulary, const std::string& name) {
    const auto found = vocabulary.sensors.find(name);
    if (found != vocabulary.sensors.end()) return found->second;
    std::string known;
    for (const auto& [other, sensor] : vocabulary.sensors) known += (known.empty() ? "" : ", ") + other;
    throw BadFrame("sensor '" + shown(name) + "' is none of those in slot sensors: " + known);
}

void check_covariance(const double* matrix, std::size_t n, const std::string& where) {
    std::vector<double> l(n * n, 0.0);  // lower Cholesky factor
    for (std::size_t r = 0; r < n; ++r)
        for (std::size_t c = 0; c <= r; ++c) {
            const double value = matrix[r * n + c], other = matrix[c * n + r];
            if (std::abs(value - other) > 1e-9 * (std::abs(value) + std::abs(other)))
                throw BadFrame(where + " is not symmetric");
            double rest = value;
            for (std::size_t k = 0; k < c; ++k) rest -= l[r * n + k] * l[c * n + k];
            if (r == c && !(rest > 0)) throw BadFrame(where + " is not positive definite");
            l[r * n + c] = r == c ? std::sqrt(rest) : rest / l[c * n + c];
        }
}

void adopt_envelope(const Datagram& told, bool first, Datagram& into) {
    if (!told.sender.empty() && !is_sender(told.sender))
        throw BadFrame("sender is not 1 to 64 printable ASCII characters");
    if (told.sequence.value_or(0) > std::uint64_t{1} << 62) throw BadFrame("sequence is beyond 2^62");
    const bool same = told.sender == into.sender && told.session == into.session && told.sequence == into.sequence;
    if (!first && !same) throw BadFrame("sender, session and sequence are not those of the datagram's first line");
    into.sender = told.sender, into.session = told.session, into.sequence = told.sequence;
}

void check_part(const std::array<std::uint64_t, 2>& part) {
    if (part[0] < 1 || part[0] > part[1] || part[1] > most_parts)
        throw BadFrame("part is " + std::to_string(part[0]) + " of " + std::to_string(part[1]) +
                       ", expected 1 to n, and n at most " + std::to_string(most_parts));
}

}  // namespace wire
