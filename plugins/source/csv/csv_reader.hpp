/// Rows of a text with delimiters (RFC 4180), one at a time.
///
/// Fields may be quoted; a quoted field may hold delimiters, line ends and doubled quotes. Lines end with LF, CRLF or the end of the
/// file. Empty lines and comment lines are passed over, a byte order mark is dropped. Spaces and tabs around an unquoted
/// field do not count. A quote within an unquoted field is a character like others.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "input_file.hpp"

namespace source_csv {

class CsvReader {
public:
    /// `delimiter` ' ' stands for any run of spaces and tabs. `comment`: what a comment line begins with, "" for none.
    CsvReader(const std::filesystem::path& path, char delimiter, std::string comment);

    enum class Answer { row, malformed, end };
    /// Reads a row. `malformed`: see problem(); the next call goes on with the next line. Throws IoError where the system
    /// cannot read.
    Answer next();

    std::size_t size() const noexcept { return ends_.size(); }
    std::string_view operator[](std::size_t field) const noexcept {
        const std::size_t first = field == 0 ? 0 : ends_[field - 1];
        return std::string_view(text_).substr(first, ends_[field] - first);
    }
    /// What is wrong with a malformed row.
    const std::string& problem() const noexcept { return problem_; }
    /// Whether the malformed row is the last there is: the file is broken off.
    bool broken_off() const noexcept { return broken_off_; }
    /// The line that the row begins in, from 1.
    std::uint64_t line() const noexcept { return first_line_; }
    const InputFile& file() const noexcept { return file_; }

    /// Where the next row begins, to be returned to.
    struct Place {
        std::uint64_t offset = 0, line = 1;
        template <class Archive> void state(Archive& archive) { archive(offset, line); }
    };
    Place place() const noexcept { return {file_.offset(), line_}; }
    void seek(const Place& place);

private:
    static constexpr std::size_t longest_row = std::size_t{1} << 20;

    Answer read_row();
    bool skip_byte_order_mark();
    bool find_row();
    bool read_field();
    void read_quoted();
    void read_plain();
    bool delimited();
    void end_field(std::size_t kept);
    void skip_blanks();
    void skip_line();
    void take_line_end();
    bool at_comment();
    bool fail(std::string problem);

    InputFile file_;
    char delimiter_;
    std::string comment_, text_, problem_;
    std::vector<std::size_t> ends_;
    std::uint64_t line_ = 1, first_line_ = 1;
    bool broken_off_ = false;
};

}  // namespace source_csv
