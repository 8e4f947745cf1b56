#include "campaign/store.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <zlib.h>

#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fmt/format.h>

#include "host/error.hpp"
#include "report/json_file.hpp"
#include "report/result_folder.hpp"

namespace pelorus::campaign {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

[[noreturn]] void fail(const std::string& what, const fs::path& path, const std::string& reason) {
    throw Error(Exit::run_failed, "cannot " + what + " " + path.string() + ": " + reason);
}

std::string reason_of(int number) { return std::generic_category().message(number); }

Json read_json(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    if (!stream) fail("read", path, reason_of(errno));
    Json json = Json::parse(stream, nullptr, false);
    if (json.is_discarded()) fail("read", path, "it is not JSON; remove the folder and begin anew");
    return json;
}

std::uint32_t checksum(const unsigned char* first, std::size_t size) {
    return static_cast<std::uint32_t>(::crc32_z(0, first, size));
}

/// Appended in one piece: what another process reads is whole records, and at most one that is not.
void append_bytes(const fs::path& path, const std::vector<unsigned char>& bytes) {
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (descriptor < 0) fail("write", path, reason_of(errno));
    std::size_t done = 0;
    int problem = 0;
    while (done < bytes.size() && problem == 0) {
        const ::ssize_t written = ::write(descriptor, bytes.data() + done, bytes.size() - done);
        if (written > 0)
            done += static_cast<std::size_t>(written);
        else if (written < 0 && errno != EINTR)
            problem = errno;
    }
    if (::close(descriptor) != 0 && problem == 0) problem = errno;
    if (problem != 0) fail("write", path, reason_of(problem));
}

/// The next record, or nothing where the rest is none.
std::optional<std::pair<std::uint64_t, Totals>> next_record(runtime::ByteReader& reader) {
    try {
        const auto expected = reader.number<std::uint32_t>();
        const std::vector<unsigned char> bytes = reader.sized();
        if (checksum(bytes.data(), bytes.size()) != expected) return std::nullopt;
        runtime::ByteReader record(bytes.data(), bytes.size());
        const auto block = record.number<std::uint64_t>();
        return std::make_pair(block, Totals::read(record));
    } catch (const runtime::CorruptBytes&) {
        return std::nullopt;
    }
}

}  // namespace

fs::path campaign_file(const fs::path& folder) { return folder / "campaign.json"; }

Store::~Store() {
    if (lock_ >= 0) ::close(lock_);
}

fs::path Store::file(std::size_t cell, const char* ending) const {
    return folder_ / "cells" / fmt::format("{:06}{}", cell, ending);
}

std::optional<Json> Store::identity() const {
    std::error_code ignored;
    if (!fs::exists(campaign_file(folder_), ignored)) return std::nullopt;
    return read_json(campaign_file(folder_));
}

void Store::lock() {
    report::prepare_folder(folder_ / "cells");
    const fs::path path = folder_ / "cells" / ".lock";
    lock_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (lock_ < 0) fail("write", path, reason_of(errno));
    if (::flock(lock_, LOCK_EX | LOCK_NB) != 0)
        throw Error(Exit::run_failed, "another campaign is at work in " + folder_.string() +
                                          "; wait for it, or name another folder with --out");
}

void Store::begin(const Json& identity) {
    std::error_code reason;
    // In this order: cells of the old campaign never lie beside the identity of the new one.
    fs::remove(campaign_file(folder_), reason);
    std::vector<fs::path> old;
    for (fs::directory_iterator entry(folder_ / "cells", reason), end; !reason && entry != end; entry.increment(reason))
        if (entry->path().filename() != ".lock") old.push_back(entry->path());
    for (const fs::path& path : old)
        if (!reason) fs::remove(path, reason);
    if (reason) fail("empty", folder_ / "cells", reason.message());
    report::write_file(campaign_file(folder_), report::json_text(identity));
}

bool Store::has_cell(std::size_t cell) const {
    std::error_code ignored;
    return fs::exists(file(cell, ".json"), ignored);
}

bool Store::is_begun(std::size_t cell) const {
    std::error_code ignored;
    return has_cell(cell) || fs::exists(file(cell, ".blocks"), ignored);
}

Json Store::cell(std::size_t cell) const { return read_json(file(cell, ".json")); }

std::vector<std::pair<std::uint64_t, Totals>> Store::blocks(std::size_t cell) const {
    const fs::path path = file(cell, ".blocks");
    std::vector<std::pair<std::uint64_t, Totals>> found;
    std::ifstream stream(path, std::ios::binary);
    if (!stream) return found;
    const std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(stream), {}};
    runtime::ByteReader reader(bytes.data(), bytes.size());
    std::size_t good = 0;
    while (auto record = next_record(reader)) {
        found.push_back(std::move(*record));
        good = bytes.size() - reader.left();
    }
    std::error_code reason;
    if (good < bytes.size()) fs::resize_file(path, good, reason);
    if (reason) fail("shorten", path, reason.message());
    return found;
}

void Store::append(std::size_t cell, std::uint64_t block, const Totals& totals) const {
    runtime::ByteWriter record;
    record.number(block);
    totals.write(record);
    runtime::ByteWriter framed;
    framed.number(checksum(record.bytes().data(), record.bytes().size()));
    framed.sized(record.bytes().data(), record.bytes().size());
    append_bytes(file(cell, ".blocks"), framed.bytes());
}

void Store::finish(std::size_t cell, const Json& finished) const {
    report::write_file(file(cell, ".json"), report::json_text(finished));
    std::error_code ignored;  // what stays is never read: the cell is there
    fs::remove(file(cell, ".blocks"), ignored);
}

}  // namespace pelorus::campaign
