/// PNG files as a browser writes them: 8 bits a channel, RGB or RGBA, not interlaced.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

namespace pelorus::test {

struct Picture {
    std::size_t width = 0, height = 0;
    std::vector<unsigned char> pixels;  ///< R, G, B row by row

    /// 0 (black) to 255 (white), over all pixels.
    double mean_brightness() const;
    /// Different colours, up to 1000.
    std::size_t colours() const;
};

/// Throws std::runtime_error for another kind of file.
Picture read_png(const std::filesystem::path& file);

}  // namespace pelorus::test
