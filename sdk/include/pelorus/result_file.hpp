/// A file that a sink writes: complete or not there, and exact again after a resume.
///
///     ResultFile file_;                                  // member
///     file_.setup(setup, "file", "tracks.csv");          // in setup(): touches nothing
///     file_.write("time,id\n");                          // from the first message on
///     file_.finish();                                    // in finish()
///     archive(file_);                                    // in state()
///
/// A relative name lies in the result folder of the run (ABI output.h). The file grows as NAME.part and gets its name when
/// it is finished, so that a reader never sees half of one; what an ended process leaves behind keeps its partial name.
/// Saved state is the length so far and a fingerprint of the bytes: on resuming, they are looked for in the partial or finished
/// file, in the present result folder or in the one where they were written, and what came after them is dropped.
/// All calls [worker, exclusive]; errors are IoError and name file and reason.
#pragma once

#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <string>
#include <string_view>
#include <sys/file.h>
#include <system_error>
#include <unistd.h>
#include <vector>

#include <pelorus/archive.hpp>
#include <pelorus/setup.hpp>

namespace pelorus {

class ResultFile {
public:
    ResultFile() = default;
    ResultFile(const ResultFile&) = delete;
    ResultFile& operator=(const ResultFile&) = delete;
    ~ResultFile() {
        if (descriptor_ >= 0) ::close(descriptor_);
    }

    /// Throws ParameterError where the name is no name of a file.
    void setup(const Setup& setup, const std::string& parameter, const std::string& name) {
        service_ = setup.optional_service<plr_output>();
        rename(parameter, name);
    }
    /// The same for a further file of the same sink.
    void setup(const ResultFile& sibling, const std::string& parameter, const std::string& name) {
        service_ = sibling.service_;
        rename(parameter, name);
    }

    void write(std::string_view text) {
        if (descriptor_ < 0) open();
        buffer_.append(text);
        if (buffer_.size() >= buffer_limit) flush();
    }
    /// The shortest decimal that reads back as the same number.
    void number(double value) {
        char text[32];
        write({text, static_cast<std::size_t>(std::to_chars(text, text + sizeof text, value).ptr - text)});
    }
    /// A fixed number of decimals.
    void fixed(double value, int decimals) {
        char text[512];
        const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, decimals).ptr;
        write({text, static_cast<std::size_t>(end - text)});
    }
    void integer(std::uint64_t value) { write(std::to_string(value)); }
    void integer(std::int64_t value) { write(std::to_string(value)); }
    /// A time in ns as exact seconds: 12.109.
    void seconds(std::int64_t time) {
        const bool negative = time < 0;
        const std::uint64_t size = negative ? 0 - static_cast<std::uint64_t>(time) : static_cast<std::uint64_t>(time);
        std::string text = (negative ? "-" : "") + std::to_string(size / 1'000'000'000u);
        const std::string fraction = std::to_string(1'000'000'000u + size % 1'000'000'000u).substr(1);
        const auto last = fraction.find_last_not_of('0');
        if (last != std::string::npos) text += "." + fraction.substr(0, last + 1);
        write(text);
    }

    /// Bytes so far, those not yet handed to the operating system included.
    std::uint64_t size() const noexcept { return size_ + buffer_.size(); }

    /// Hands everything to the operating system.
    void flush() {
        const char* at = buffer_.data();
        for (std::size_t left = buffer_.size(); left > 0;) {
            const ssize_t written = ::write(descriptor_, at, left);
            if (written < 0 && errno == EINTR) continue;
            if (written < 0) {
                const int reason = errno;
                buffer_.erase(0, buffer_.size() - left);  // or a later try would write the first part twice
                fail("cannot write", part(), reason);
            }
            fingerprint_ = continue_fingerprint(fingerprint_, at, static_cast<std::size_t>(written));
            size_ += static_cast<std::uint64_t>(written);
            at += written;
            left -= static_cast<std::size_t>(written);
        }
        buffer_.clear();
    }

    /// Completes the file under its name. Does nothing where nothing was ever written.
    void finish() {
        if (descriptor_ < 0) {
            if (size_ == 0) return;
            open();  // resumed, and nothing came any more
        }
        flush();
        if (::fsync(descriptor_) != 0) fail("cannot write", part(), errno);
        if (::rename(part().c_str(), path().c_str()) != 0)
            fail("cannot rename " + part().string() + " to", path(), errno);
        ::close(descriptor_);
        descriptor_ = -1;
        size_ = 0;
    }

    template <class Archive> void state(Archive& archive) {
        if constexpr (Archive::reading) {
            if (descriptor_ >= 0) ::close(descriptor_);
            descriptor_ = -1;
            buffer_.clear();
        } else if (descriptor_ >= 0) {
            flush();
            written_in_ = folder().string();
        }
        archive(size_, fingerprint_, written_in_);
        if constexpr (Archive::reading)
            if (size_ > 0) find_bytes();
    }

private:
    static constexpr std::size_t buffer_limit = std::size_t{1} << 16;
    static constexpr std::uint64_t fingerprint_start = 14695981039346656037u;

    /// FNV-1a, 64 bits: against chance, not against malice.
    static std::uint64_t continue_fingerprint(std::uint64_t hash, const char* bytes, std::size_t size) noexcept {
        for (std::size_t i = 0; i < size; ++i) hash = (hash ^ static_cast<unsigned char>(bytes[i])) * 1099511628211u;
        return hash;
    }
    [[noreturn]] static void fail(const std::string& what, const std::filesystem::path& file, int reason) {
        throw IoError(what + " " + file.string() + ": " + std::generic_category().message(reason));
    }

    void rename(const std::string& parameter, const std::string& name) {
        const std::filesystem::path given(name);
        if (!given.has_filename() || given.filename() == "." || given.filename() == "..")
            throw ParameterError(parameter, "'" + name + "' is not the name of a file");
        name_ = given;
    }
    std::filesystem::path folder() const {
        if (name_.is_absolute()) return {};
        const char* given = service_ == nullptr ? nullptr : service_->folder(service_->context);
        if (given == nullptr)
            throw IoError("cannot write " + name_.string() +
                          ": this run has no result folder, and the name is relative");
        return given;
    }
    std::filesystem::path path() const { return folder() / name_; }
    std::filesystem::path part() const { return path().string() + ".part"; }

    void open() {
        const std::filesystem::path file = part();
        std::error_code failure;
        std::filesystem::create_directories(file.parent_path(), failure);
        if (failure) fail("cannot make the folder of", path(), failure.value());
        const std::filesystem::path from = size_ > 0 ? find_bytes() : std::filesystem::path();
        descriptor_ = ::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
        if (descriptor_ < 0) fail("cannot write", file, errno);
        const std::uint64_t size = size_, fingerprint = fingerprint_;
        try {
            prepare(file, from);
        } catch (...) {
            ::close(descriptor_);
            descriptor_ = -1;  // or finish() would complete what was not prepared, perhaps somebody else's file
            size_ = size;
            fingerprint_ = fingerprint;
            buffer_.clear();
            throw;
        }
    }

    /// Gives the opened file the bytes written so far, which stand in `from` (empty: nowhere, there are none).
    void prepare(const std::filesystem::path& file, const std::filesystem::path& from) {
        if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0)
            throw IoError("cannot write " + file.string() +
                          ": somebody else is writing it (another sink, another run)");
        if (from.empty() || from == file) {
            if (::ftruncate(descriptor_, static_cast<off_t>(size_)) != 0) fail("cannot write", file, errno);
            if (::lseek(descriptor_, 0, SEEK_END) < 0) fail("cannot write", file, errno);
        } else {
            if (::ftruncate(descriptor_, 0) != 0) fail("cannot write", file, errno);
            copy(from);
        }
    }

    /// The file whose first size_ bytes are those of the saved state.
    std::filesystem::path find_bytes() const {
        std::vector<std::filesystem::path> places{part(), path()};
        if (!written_in_.empty()) {
            const std::filesystem::path before = std::filesystem::path(written_in_) / name_;
            places.insert(places.end(), {before.string() + ".part", before});
        }
        for (const auto& place : places) {
            std::uint64_t hash = fingerprint_start;
            const bool whole = read(
                place, size_, [&](const char* bytes, std::size_t n) { hash = continue_fingerprint(hash, bytes, n); });
            if (whole && hash == fingerprint_) return place;
        }
        throw IoError("cannot resume " + path().string() + ": its first " + std::to_string(size_) +
                      " bytes are needed, and neither it nor a partial file of that name holds them");
    }
    /// Reads the first `left` bytes; false where there are not so many.
    template <class Take> static bool read(const std::filesystem::path& file, std::uint64_t left, Take take) {
        const int from = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
        if (from < 0) return false;
        std::vector<char> block(buffer_limit);
        while (left > 0) {
            const ssize_t n = ::read(from, block.data(), std::min<std::uint64_t>(left, block.size()));
            if (n < 0 && errno == EINTR) continue;
            if (n <= 0) break;
            take(block.data(), static_cast<std::size_t>(n));
            left -= static_cast<std::uint64_t>(n);
        }
        ::close(from);
        return left == 0;
    }
    /// Writes the first size_ bytes of another file.
    void copy(const std::filesystem::path& from) {
        const std::uint64_t wanted = size_;
        size_ = 0;
        fingerprint_ = fingerprint_start;
        const bool whole = read(from, wanted, [&](const char* bytes, std::size_t n) {
            buffer_.assign(bytes, n);
            flush();
        });
        if (!whole) fail("cannot read", from, EIO);
    }

    std::filesystem::path name_;
    const plr_output* service_ = nullptr;
    std::string buffer_, written_in_;
    std::uint64_t size_ = 0;  // of what the operating system has
    std::uint64_t fingerprint_ = fingerprint_start;
    int descriptor_ = -1;
};

}  // namespace pelorus
