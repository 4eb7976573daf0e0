#include "face/order.hpp"

#include <cstring>
#include <utility>

namespace rabiline {
namespace {

using Texts = std::vector<std::string>;

std::string bytes_of(const std::vector<std::pair<std::uint64_t, std::uint64_t>>& intervals) {
  std::string out;
  for (const auto& [begin, end] : intervals)
    for (const std::uint64_t number : {begin, end})
      out.append(reinterpret_cast<const char*>(&number), sizeof number);
  return out;
}
std::vector<std::pair<std::uint64_t, std::uint64_t>> intervals_of(const std::string& bytes) {
  std::vector<std::uint64_t> numbers(bytes.size() / sizeof(std::uint64_t));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), bytes.size());
  std::vector<std::pair<std::uint64_t, std::uint64_t>> out;
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) out.emplace_back(numbers[i], numbers[i + 1]);
  return out;
}

/// Texts one after the other, as they are read.
class Letter {
 public:
  explicit Letter(Texts texts) : texts_(std::move(texts)) {}
  std::string text() { return std::move(texts_.at(at_++)); }
  std::uint64_t number() { return std::stoull(text()); }

 private:
  Texts texts_;
  std::size_t at_ = 0;
};

struct Order {
  Snapshot start;
  RunSettings settings;
};

Order read_order(Letter& letter) {
  Order order;
  order.settings.threads = static_cast<int>(letter.number());
  order.settings.batch = static_cast<int>(letter.number());
  order.settings.isa = letter.text();
  Snapshot& start = order.start;
  start.transit = order.settings.transit = static_cast<KeptTransit>(letter.number());
  start.max_memory = order.settings.max_memory = letter.number();
  start.shard.number = letter.number();
  start.shard.of = letter.number();
  order.settings.shard = start.shard;
  start.fingerprint = letter.text();
  start.particles = letter.number();
  start.sums.size = letter.number();
  start.finished = intervals_of(letter.text());
  for (std::uint64_t count = letter.number(); count > 0; --count) start.changes.push_back(letter.text());
  for (std::uint64_t count = letter.number(); count > 0; --count) {
    std::string path = letter.text();
    start.inputs.push_back({std::move(path), letter.text()});
  }
  return order;
}

}  // namespace

void give_order(const Snapshot& start, const RunSettings& settings) {
  const auto text = [](auto number) { return std::to_string(number); };
  Texts order{"fly",
              text(settings.threads),
              text(settings.batch),
              settings.isa,
              text(static_cast<int>(settings.transit)),
              text(settings.max_memory),
              text(settings.shard.number),
              text(settings.shard.of),
              start.fingerprint,
              text(start.particles),
              text(start.sums.size),
              bytes_of(start.finished),
              text(start.changes.size())};
  order.insert(order.end(), start.changes.begin(), start.changes.end());
  order.push_back(text(start.inputs.size()));
  for (const InputText& input : start.inputs) order.insert(order.end(), {input.path, input.text});
  settings.ranks->broadcast(order);
}

int assist(Ranks& ranks, const std::atomic<bool>* stop) {
  for (;;) {
    Letter letter(ranks.broadcast({}));
    if (letter.text() == "go home") return static_cast<int>(letter.number());
    try {
      Order order = read_order(letter);
      const Setup setup = load(order.start);
      order.settings.start = &order.start;
      order.settings.stop = stop;
      order.settings.ranks = &ranks;
      run(setup, order.settings);
    } catch (const RankFailure&) {
      continue;  // the leader says it
    } catch (const std::exception& error) {
      ranks.give_up(error.what());
    }
  }
}

void dismiss(Ranks& ranks, int exit_code) { ranks.broadcast({"go home", std::to_string(exit_code)}); }

}  // namespace rabiline
