#include "csv_reader.hpp"

#include <pelorus/failure.hpp>

namespace source_csv {

namespace {

bool is_blank(int c) { return c == ' ' || c == '\t' || c == '\r'; }

}  // namespace

CsvReader::CsvReader(const std::filesystem::path& path, char delimiter, std::string comment)
    : file_(path), delimiter_(delimiter), comment_(std::move(comment)) {}

void CsvReader::seek(const Place& place) {
    file_.seek(place.offset);
    line_ = place.line;
    broken_off_ = false;
}

CsvReader::Answer CsvReader::next() {
    if (broken_off_) return Answer::end;
    try {
        return read_row();
    } catch (const pelorus::DataError& error) {  // compressed data: nothing after this place can be read
        fail(error.what());
        broken_off_ = true;
        return Answer::malformed;
    }
}

CsvReader::Answer CsvReader::read_row() {
    if (file_.offset() == 0 && !skip_byte_order_mark()) return Answer::malformed;
    do {
        text_.clear();
        ends_.clear();
        if (!find_row()) return Answer::end;
        first_line_ = line_;
        while (read_field())
            if (!delimited()) break;
        if (!problem_.empty()) return skip_line(), Answer::malformed;
    } while (size() == 1 && text_.empty());  // a line of blanks
    return Answer::row;
}

bool CsvReader::skip_byte_order_mark() {
    if (file_.peek() != 0xEF) return true;
    for (const int expected : {0xEF, 0xBB, 0xBF})
        if (file_.get() != expected) {
            first_line_ = line_;
            skip_line();
            return fail("begins with bytes that are no UTF-8 text");
        }
    return true;
}

/// Passes over lines that are no rows. False at the end of the file.
bool CsvReader::find_row() {
    problem_.clear();
    for (;;) {
        if (delimiter_ == ' ' || file_.peek() == '\r') skip_blanks();
        if (file_.peek() < 0) return false;
        if (file_.peek() == '\n')
            take_line_end();
        else if (at_comment())
            skip_line();
        else
            return true;
    }
}

bool CsvReader::read_field() {
    // What at_comment has read in vain is the beginning of the first field.
    const bool begun = ends_.empty() && !text_.empty();
    if (!begun) skip_blanks();
    if (!begun && file_.peek() == '"')
        read_quoted();
    else
        read_plain();
    if (problem_.empty() && text_.size() > longest_row)
        fail("is longer than " + std::to_string(longest_row) + " bytes (is a quote not closed?)");
    return problem_.empty();
}

/// Takes what ends a field. False: it was the row's last one.
bool CsvReader::delimited() {
    if (delimiter_ == ' ') skip_blanks();
    if (file_.peek() < 0) return false;
    if (file_.peek() == '\n') return take_line_end(), false;
    if (delimiter_ != ' ') file_.get();
    return true;
}

/// A quoted field, and the blanks behind it.
void CsvReader::read_quoted() {
    file_.get();
    while (text_.size() <= longest_row) {
        const int c = file_.get();
        if (c < 0) return void(fail("ends within a quoted field"));
        if (c == '"') {
            if (file_.peek() != '"') break;
            file_.get();
        } else if (c == '\n') {
            ++line_;
        }
        text_ += static_cast<char>(c);
    }
    end_field(text_.size());
    if (text_.size() > longest_row) return;
    skip_blanks();
    const int c = file_.peek();
    if (c >= 0 && c != '\n' && c != delimiter_ && delimiter_ != ' ')
        fail("has text after the closing quote of field " + std::to_string(size()));
}

void CsvReader::read_plain() {
    while (text_.size() <= longest_row) {
        const int c = file_.peek();
        if (c < 0 || c == '\n' || c == delimiter_ || (delimiter_ == ' ' && c == '\t')) break;
        text_ += static_cast<char>(file_.get());
    }
    const std::size_t first = ends_.empty() ? 0 : ends_.back();
    std::size_t kept = text_.size();
    while (kept > first && is_blank(text_[kept - 1])) --kept;
    end_field(kept);
}

void CsvReader::end_field(std::size_t kept) {
    text_.resize(kept);
    ends_.push_back(kept);
}

/// Blanks do not count at the beginning of a field, unless they delimit. A carriage return is one: it stands before the line's end.
void CsvReader::skip_blanks() {
    while (is_blank(file_.peek()) && (delimiter_ == ' ' || file_.peek() != delimiter_)) file_.get();
}

void CsvReader::take_line_end() {
    file_.get();
    ++line_;
}

/// Whether the line begins with the comment mark; what was read to find out is the beginning of the first field otherwise.
bool CsvReader::at_comment() {
    if (comment_.empty()) return false;
    for (const char c : comment_) {
        if (file_.peek() != static_cast<unsigned char>(c)) return false;
        text_ += static_cast<char>(file_.get());
    }
    text_.clear();
    return true;
}

void CsvReader::skip_line() {
    for (int c = file_.get(); c >= 0; c = file_.get())
        if (c == '\n') {
            ++line_;
            return;
        }
}

bool CsvReader::fail(std::string problem) {
    problem_ = std::move(problem);
    return false;
}

}  // namespace source_csv
