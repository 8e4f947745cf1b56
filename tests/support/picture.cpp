#include "picture.hpp"

#include <cstdint>
#include <cstdlib>
#include <set>
#include <stdexcept>
#include <string>

#include <zlib.h>

#include "process.hpp"

namespace pelorus::test {

namespace {

std::size_t number_at(const std::string& bytes, std::size_t at) {
    std::size_t number = 0;
    for (std::size_t i = at; i < at + 4; ++i) number = number << 8 | static_cast<unsigned char>(bytes.at(i));
    return number;
}

std::vector<unsigned char> inflated(const std::string& packed, std::size_t size) {
    std::vector<unsigned char> bytes(size);
    auto length = static_cast<::uLongf>(size);
    if (::uncompress(bytes.data(), &length, reinterpret_cast<const ::Bytef*>(packed.data()),
                     static_cast<::uLong>(packed.size())) != Z_OK ||
        length != size)
        throw std::runtime_error("a PNG whose pixels cannot be unpacked");
    return bytes;
}

int paeth(int left, int above, int corner) {
    const int guess = left + above - corner;
    const int a = std::abs(guess - left), b = std::abs(guess - above), c = std::abs(guess - corner);
    return a <= b && a <= c ? left : b <= c ? above : corner;
}

/// Takes the filters of a row off, which are told by its first byte (PNG specification, 9).
void unfilter(unsigned char* row, const unsigned char* above, std::size_t size, std::size_t channels) {
    for (std::size_t i = 1; i <= size; ++i) {
        const int left = i > channels ? row[i - channels] : 0, up = above != nullptr ? above[i] : 0,
                  corner = above != nullptr && i > channels ? above[i - channels] : 0;
        const int added[] = {0, left, up, (left + up) / 2, paeth(left, up, corner)};
        if (row[0] > 4) throw std::runtime_error("a PNG with a filter that there is not");
        row[i] = static_cast<unsigned char>(row[i] + added[row[0]]);
    }
}

}  // namespace

double Picture::mean_brightness() const {
    double sum = 0;
    for (const unsigned char value : pixels) sum += value;
    return pixels.empty() ? 0 : sum / static_cast<double>(pixels.size());
}

std::size_t Picture::colours() const {
    std::set<std::uint32_t> seen;
    for (std::size_t i = 0; i + 2 < pixels.size() && seen.size() < 1000; i += 3)
        seen.insert(static_cast<std::uint32_t>(pixels[i]) << 16 | static_cast<std::uint32_t>(pixels[i + 1]) << 8 |
                    pixels[i + 2]);
    return seen.size();
}

Picture read_png(const std::filesystem::path& file) {
    const std::string bytes = read_file(file);
    if (bytes.compare(0, 8, "\x89PNG\r\n\x1a\n") != 0) throw std::runtime_error(file.string() + " is no PNG");
    Picture picture;
    std::size_t channels = 0;
    std::string packed;
    for (std::size_t at = 8; at + 12 <= bytes.size();) {
        const std::size_t size = number_at(bytes, at);
        const std::string kind = bytes.substr(at + 4, 4);
        if (kind == "IHDR") {
            picture.width = number_at(bytes, at + 8);
            picture.height = number_at(bytes, at + 12);
            channels = bytes.at(at + 17) == 6 ? 4 : bytes.at(at + 17) == 2 ? 3 : 0;
            if (channels == 0 || bytes.at(at + 16) != 8 || bytes.at(at + 20) != 0)
                throw std::runtime_error("a PNG of another kind than browsers write");
        }
        if (kind == "IDAT") packed += bytes.substr(at + 8, size);
        at += size + 12;
    }
    const std::size_t row = picture.width * channels + 1;
    std::vector<unsigned char> rows = inflated(packed, row * picture.height);
    for (std::size_t y = 0; y < picture.height; ++y) {
        unfilter(&rows[y * row], y > 0 ? &rows[(y - 1) * row] : nullptr, row - 1, channels);
        for (std::size_t x = 0; x < picture.width; ++x)
            for (std::size_t c = 0; c < 3; ++c) picture.pixels.push_back(rows[y * row + 1 + x * channels + c]);
    }
    return picture;
}

}  // namespace pelorus::test
