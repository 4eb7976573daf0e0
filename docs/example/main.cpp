// example FILE OUT.h5: the suggested experiment in a weaker field at three frequencies.
#include <cstdio>
#include <rabiline/rabiline.hpp>

int main(int count, char** arguments) {
  if (count != 3) return std::fputs("usage: example FILE OUT.h5\n", stderr), 2;
  try {
    const rabiline::Setup setup = rabiline::load(
        arguments[1],
        {.set = {"B.field=9 mT"}, .scan = {"H0.frequency=250 kHz:270 kHz:3"}, .particles = "1000"});
    for (const rabiline::Diagnostic& warning : rabiline::check(setup).warnings)
      std::fputs(rabiline::render(warning).c_str(), stderr);

    const std::optional<rabiline::Result> result = rabiline::run(setup, {.threads = 2});
    const rabiline::ScanAxis& frequency = result->axes.front();
    const rabiline::DetectorResult& screen = result->detectors.front();
    for (std::size_t i = 0; i < frequency.values.size(); ++i)
      std::printf("%s: %.4f +- %.4f detected\n", value_at(frequency, i).c_str(), screen.detected[i],
                  screen.detected_errors[i]);
    rabiline::write(*result, arguments[2]);
  } catch (const std::exception& error) {  // everything that is wrong, each with its line
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
