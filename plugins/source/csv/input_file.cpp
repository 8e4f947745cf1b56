#include "input_file.hpp"

#include <cerrno>
#include <fcntl.h>
#include <string>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

#include <pelorus/failure.hpp>

namespace source_csv {

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& why) {
    throw pelorus::IoError("cannot read " + path.string() + ": " + why);
}
std::string system_text(int code) { return std::generic_category().message(code); }

}  // namespace

InputFile::InputFile(const std::filesystem::path& path) : path_(path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) fail(path, system_text(errno));
    struct stat facts {};
    if (::fstat(descriptor, &facts) != 0 || S_ISDIR(facts.st_mode)) {
        ::close(descriptor);
        fail(path, "it is a folder");
    }
    size_ = static_cast<std::uint64_t>(facts.st_size);
    file_.reset(gzdopen(descriptor, "rb"));
    if (!file_) {
        ::close(descriptor);
        fail(path, "out of memory");
    }
    gzbuffer(file_.get(), static_cast<unsigned>(block_.size()) * 2);
}

bool InputFile::refill() {
    const int count = gzread(file_.get(), block_.data(), static_cast<unsigned>(block_.size()));
    at_ = 0;
    end_ = count > 0 ? static_cast<std::size_t>(count) : 0;
    if (end_ > 0) return true;
    int code = Z_OK;
    std::string text = gzerror(file_.get(), &code);
    if (const std::size_t colon = text.find(">: "); colon != std::string::npos)  // `<fd:3>: incorrect data check`
        text = text.substr(colon + 3);
    if (code == Z_OK || code == Z_STREAM_END) return false;
    if (code == Z_ERRNO) fail(path_, system_text(errno));
    throw pelorus::DataError(code == Z_BUF_ERROR ? "the compressed data end early"
                                                 : "the compressed data are damaged (" + text + ")");
}

void InputFile::seek(std::uint64_t offset) {
    at_ = end_ = 0;
    gzclearerr(file_.get());
    if (gzseek(file_.get(), static_cast<z_off_t>(offset), SEEK_SET) < 0) fail(path_, "cannot seek in it");
    offset_ = offset;
}

}  // namespace source_csv
