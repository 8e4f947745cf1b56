// A sink: tracks as lines of text, with what a sink may do wrong.
#include <fstream>

#include <pelorus/pelorus.hpp>
#include <pelorus/result_file.hpp>

#include "defect.h"

namespace {

struct Saboteur : pelorus::Stage<Saboteur> {
    static constexpr const char* kind = "sink";

    pelorus::ResultFile file;
    std::string folder, failure;
    bool is_finished = false;

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("A sink with a defect").purpose("Writes tracks as lines, for the proof that the suites can fail.");
        plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "what is written");
    }
    void setup(const pelorus::Setup& setup) {
        file.setup(setup, "file", NEAR_MISS("sink-writes-where-it-is-told") ? "below/tracks.txt" : "tracks.txt");
        if (const auto* const output = setup.optional_service<plr_output>())
            if (const char* const given = output->folder(output->context)) folder = given;
        if (DEFECT("sink-writes-nothing-early")) std::ofstream(folder + "/header.txt") << "id\n";
    }
    ~Saboteur() {
        if (DEFECT("sink-files-are-complete") && is_finished)
            std::ofstream(folder + "/tracks.txt", std::ios::app) << "end\n";
    }

    void on_tracks(const pelorus::Event&, const plr_tracks& tracks) {
        if (DEFECT("sink-writes-where-it-is-told")) std::ofstream("saboteur.log") << "a message\n";
        if (NEAR_MISS("sink-writes-nothing-early")) std::ofstream(folder + "/header.txt") << "id\n";
        for (std::int64_t i = 0; i < tracks.count; ++i) {
            try {
                file.seconds(tracks.times[i]);
                file.write(" ");
                file.integer(tracks.ids[i]);
                file.write("\n");
            } catch (const pelorus::IoError& error) {
                if (NEAR_MISS("sink-tells-what-it-cannot-write"))
                    failure = error.what();
                else if (!DEFECT("sink-tells-what-it-cannot-write"))
                    throw;
            }
        }
    }
    void finish(const pelorus::Event&) {
        if (!failure.empty()) throw pelorus::IoError(failure);
        file.finish();
        is_finished = true;
        if (NEAR_MISS("sink-files-are-complete")) std::ofstream(folder + "/done.txt") << "complete\n";
    }
    template <class Archive> void state(Archive& archive) { archive(file); }
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.sink.saboteur");
