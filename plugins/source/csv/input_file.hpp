/// The bytes of a file, plain or gzip, whichever its content says, in constant memory.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>

#include <zlib.h>

namespace source_csv {

class InputFile {
public:
    /// Throws IoError naming the file: not there, not a regular file or pipe, not readable.
    explicit InputFile(const std::filesystem::path& path);

    /// The next byte, or -1 at the end. Throws IoError where the system cannot read, DataError where compressed data are
    /// damaged or end early.
    int get() {
        if (at_ == end_ && !refill()) return -1;
        ++offset_;
        return block_[at_++];
    }
    int peek() {
        if (at_ == end_ && !refill()) return -1;
        return block_[at_];
    }
    /// Bytes read so far, after decompression.
    std::uint64_t offset() const noexcept { return offset_; }
    /// Goes to an offset; in a compressed file by reading from its beginning. Throws like get().
    void seek(std::uint64_t offset);

    const std::filesystem::path& path() const noexcept { return path_; }
    /// Size on disk, bytes: tells a file that has changed since a state was saved.
    std::uint64_t size() const noexcept { return size_; }

private:
    bool refill();
    struct Close {
        void operator()(gzFile_s* file) const noexcept { gzclose_r(file); }
    };

    std::filesystem::path path_;
    std::unique_ptr<gzFile_s, Close> file_;
    std::array<unsigned char, std::size_t{1} << 16> block_{};
    std::size_t at_ = 0, end_ = 0;
    std::uint64_t offset_ = 0, size_ = 0;
};

}  // namespace source_csv
