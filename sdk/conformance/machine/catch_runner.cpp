// Signals are ours: a fault in guarded memory has to be told by name.
#define CATCH_CONFIG_RUNNER
#define CATCH_CONFIG_NO_POSIX_SIGNALS
#include "catch_runner.hpp"

#include <catch2/catch.hpp>

namespace pelorus::conformance {

namespace {

void (*tell_failure)(const std::string& text) = nullptr;

class Collector : public Catch::StreamingReporterBase<Collector> {
public:
    using StreamingReporterBase::StreamingReporterBase;
    static std::string getDescription() { return "hands failures to the conformance report"; }
    void assertionStarting(const Catch::AssertionInfo&) override {}
    bool assertionEnded(const Catch::AssertionStats& stats) override {
        const Catch::AssertionResult& result = stats.assertionResult;
        if (result.isOk()) return true;
        std::string text;
        const auto add = [&](const std::string& more) { text += (text.empty() || more.empty() ? "" : ": ") + more; };
        for (const Catch::MessageInfo& info : stats.infoMessages)
            if (info.type == Catch::ResultWas::Info) add(info.message);
        if (result.hasMessage()) add(result.getMessage());
        if (result.hasExpression())
            add("expected " + result.getExpressionInMacro() + ", which is " + result.getExpandedExpression());
        tell_failure(text);
        return true;
    }
};
CATCH_REGISTER_REPORTER("conformance", Collector)

}  // namespace

void run_catch(const std::string& test_case, void (*failed)(const std::string& text)) {
    tell_failure = failed;
    Catch::Session session;
    session.configData().reporterName = "conformance";
    session.configData().testsOrTags = {"\"" + test_case + "\""};
    session.configData().warnings = Catch::WarnAbout::NoTests;
    session.run();
}

}  // namespace pelorus::conformance
