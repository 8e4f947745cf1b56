#include "runtime/message_bytes.hpp"

#include <deque>
#include <memory>

#include "runtime/message_check.hpp"
#include "runtime/message_copy.hpp"
#include "runtime/message_fields.hpp"

namespace pelorus::runtime {
namespace {

class FieldWriter {
public:
    explicit FieldWriter(ByteWriter& out) : out_(out) {}

    template <class Number> void value(Number& x) { out_.number(x); }
    void count(const char*, std::int64_t& n) { out_.number(n); }
    void text(const char*, const char*& given) { out_.sized(given, std::strlen(given)); }
    void text_or_null(const char* field, const char*& given) {
        if (present(given)) text(field, given);
    }
    void texts(const char* field, const char* const*& given, std::uint32_t n) {
        if (!present(given)) return;
        for (std::uint32_t i = 0; i < n; ++i) {
            const char* one = given[i];
            text(field, one);
        }
    }
    template <class Number> void array(const char*, const Number*& given, std::int64_t n, unsigned) {
        if (present(given)) out_.block(given, static_cast<std::size_t>(n) * sizeof(Number));
    }
    std::int64_t offsets(const char* field, const std::int64_t*& given, std::int64_t n, unsigned flags) {
        array(field, given, n + 1, flags);
        return given && n > 0 ? given[n] : 0;
    }
    void view(const char*, plr_const_view& given, std::int64_t, std::int64_t, std::int64_t n, unsigned) {
        // Messages here are copies made by copy_message: packed, or one common matrix.
        out_.number(given.rows);
        out_.number(given.cols);
        if (!present(given.data)) return;
        const bool common = given.item_stride == 0;
        out_.number(static_cast<std::uint8_t>(common));
        out_.block(given.data, static_cast<std::size_t>(given.rows * given.cols * (common ? 1 : n)) * sizeof(double));
    }
    std::int64_t space(const char* field, const plr_space*& given, unsigned) {
        if (!present(given)) return 0;
        out_.number(given->size);
        elements(field, given->components, given->size);
        return given->size;
    }
    template <class Struct> void elements(const char*, const Struct* first, std::uint32_t n) {
        for (std::uint32_t i = 0; i < n; ++i) {
            Struct element = known_element(first, i);
            visit_fields(*this, element);
        }
    }

private:
    bool present(const void* given) {
        out_.number(static_cast<std::uint8_t>(given != nullptr));
        return given != nullptr;
    }
    ByteWriter& out_;
};

/// Rebuilds the structs in memory of its own; what it rebuilt is then checked and copied like any published message.
class FieldReader {
public:
    explicit FieldReader(ByteReader& in) : in_(in) {}

    template <class Body> const Body* body() {
        Body& place = *allocate<Body>(1);
        place.struct_size = sizeof(Body);
        visit_fields(*this, place);
        return &place;
    }

    template <class Number> void value(Number& x) { x = in_.number<Number>(); }
    void count(const char*, std::int64_t& n) {
        n = in_.number<std::int64_t>();
        if (n < 0 || n > std::int64_t{1} << 40) throw CorruptBytes("a count is out of range");
    }
    void text(const char*, const char*& given) { given = texts_.emplace_back(in_.text()).c_str(); }
    void text_or_null(const char* field, const char*& given) {
        if (in_.flag()) text(field, given);
    }
    void texts(const char* field, const char* const*& given, std::uint32_t n) {
        if (!in_.flag()) return;
        expect_entries(n);
        const char** place = allocate<const char*>(n);
        for (std::uint32_t i = 0; i < n; ++i) text(field, place[i]);
        given = place;
    }
    template <class Number> void array(const char*, const Number*& given, std::int64_t n, unsigned) {
        if (in_.flag()) given = numbers<Number>(n);
    }
    std::int64_t offsets(const char* field, const std::int64_t*& given, std::int64_t n, unsigned flags) {
        array(field, given, n + 1, flags);
        const std::int64_t last = given && n > 0 ? given[n] : 0;
        if (last < 0) throw CorruptBytes("an offset is negative");
        return last;
    }
    void view(const char*, plr_const_view& given, std::int64_t, std::int64_t, std::int64_t n, unsigned) {
        given.rows = in_.number<std::int64_t>();
        given.cols = in_.number<std::int64_t>();
        given.count = n;
        std::int64_t size = 0, all = 0;
        if (given.rows < 0 || given.cols < 0 || __builtin_mul_overflow(given.rows, given.cols, &size))
            throw CorruptBytes("a matrix has an impossible size");
        given.row_stride = 1, given.col_stride = given.rows, given.item_stride = size;
        if (!in_.flag()) return;
        const bool common = in_.flag();
        if (common) given.item_stride = 0;
        if (__builtin_mul_overflow(size, common ? 1 : n, &all))
            throw CorruptBytes("a list of matrices has an impossible size");
        given.data = numbers<double>(all);
    }
    std::int64_t space(const char* field, const plr_space*& given, unsigned) {
        if (!in_.flag()) return 0;
        plr_space& place = *allocate<plr_space>(1);
        place.struct_size = sizeof(plr_space);
        place.size = in_.number<std::uint32_t>();
        elements(field, place.components, place.size);
        given = &place;
        return place.size;
    }
    template <class Struct> void elements(const char*, const Struct*& first, std::uint32_t n) {
        expect_entries(n);
        Struct* place = allocate<Struct>(n);
        for (std::uint32_t i = 0; i < n; ++i) {
            place[i].struct_size = sizeof(Struct);
            visit_fields(*this, place[i]);
        }
        first = place;
    }

private:
    /// Texts and structs take eight bytes at least.
    void expect_entries(std::uint64_t n) const {
        if (n > in_.left() / 8) throw CorruptBytes("it ends within a list");
    }
    template <class T> T* allocate(std::size_t n) {
        const auto holder = std::make_shared<std::vector<T>>(n + 1);
        memory_.push_back(holder);
        return holder->data();
    }
    template <class Number> const Number* numbers(std::int64_t n) {
        if (n < 0 || static_cast<std::uint64_t>(n) > in_.left() / sizeof(Number))
            throw CorruptBytes("it ends within numbers");
        Number* place = allocate<Number>(static_cast<std::size_t>(n));
        in_.block(place, static_cast<std::size_t>(n) * sizeof(Number));
        return place;
    }

    ByteReader& in_;
    std::deque<std::string> texts_;
    std::vector<std::shared_ptr<void>> memory_;
};

template <class Body> void write_body(FieldWriter& writer, const Body& body) {
    Body fields = body;
    visit_fields(writer, fields);
}

}  // namespace

void write_message(ByteWriter& writer, const plr_message& message) {
    writer.number(message.kind);
    writer.number(message.time);
    writer.number(message.arrival);
    writer.number(message.sequence);
    FieldWriter fields(writer);
    switch (message.kind) {
        case PLR_MESSAGE_SCAN:
            return write_body(fields, *message.body.scan);
        case PLR_MESSAGE_TRACKS:
            return write_body(fields, *message.body.tracks);
        case PLR_MESSAGE_TRUTH:
            return write_body(fields, *message.body.truth);
        case PLR_MESSAGE_VALUES:
            return write_body(fields, *message.body.values);
        case PLR_MESSAGE_TABLE:
            return write_body(fields, *message.body.table);
        default:
            break;  // check_message lets no other pass
    }
}

MessageRef read_message(ByteReader& reader, MessagePool& pool) {
    plr_message message{};
    message.struct_size = sizeof message;
    message.kind = reader.number<std::uint32_t>();
    message.time = reader.number<std::int64_t>();
    message.arrival = reader.number<std::int64_t>();
    message.sequence = reader.number<std::uint64_t>();
    FieldReader fields(reader);
    switch (message.kind) {
        case PLR_MESSAGE_SCAN:
            message.body.scan = fields.body<plr_scan>();
            break;
        case PLR_MESSAGE_TRACKS:
            message.body.tracks = fields.body<plr_tracks>();
            break;
        case PLR_MESSAGE_TRUTH:
            message.body.truth = fields.body<plr_truth>();
            break;
        case PLR_MESSAGE_VALUES:
            message.body.values = fields.body<plr_values>();
            break;
        case PLR_MESSAGE_TABLE:
            message.body.table = fields.body<plr_table>();
            break;
        default:
            throw CorruptBytes("a message has an unknown kind");
    }
    CheckMemory memory;
    try {
        check_message(message, memory);
    } catch (const BadMessage& problem) {
        throw CorruptBytes(std::string("a message is malformed: ") + problem.what());
    }
    return copy_message(pool, message);
}

}  // namespace pelorus::runtime
