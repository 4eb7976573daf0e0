#pragma once
// Ranks that are threads of one process.
#include <barrier>
#include <cstring>
#include <functional>
#include <thread>

#include "simulation/ranks.hpp"

namespace rabiline::test {

/// What the members of a team hand to each other.
struct TeamTable {
  explicit TeamTable(int size) : texts(static_cast<std::size_t>(size)), sums(texts.size()), meeting(size) {}
  std::vector<std::string> texts;
  std::vector<Sums> sums;
  std::barrier<> meeting;
};

class TeamMember final : public Ranks {
 public:
  TeamMember(TeamTable& table, int rank) : table_(table), rank_(rank) {}
  int size() const override { return static_cast<int>(table_.texts.size()); }
  int rank() const override { return rank_; }
  int neighbours() const override { return size(); }
  std::vector<std::string> collect(const std::string& own) override {
    const std::vector<std::string> all = show(own);
    return leads() ? all : std::vector<std::string>{};
  }
  void add_up(Sums& own) override {
    table_.sums[static_cast<std::size_t>(rank_)] = own;
    table_.meeting.arrive_and_wait();
    if (leads())
      for (std::size_t i = 1; i < table_.sums.size(); ++i) add(own, table_.sums[i]);
    table_.meeting.arrive_and_wait();
  }
  [[noreturn]] void give_up(const std::string& why) override { throw std::runtime_error(why); }

 private:
  std::string broadcast_bytes(std::string of_leader) override { return show(of_leader).front(); }
  void exchange_bytes(const void* own, std::size_t size, void* all) override {
    char* to = static_cast<char*>(all);
    for (const std::string& text : show(std::string(static_cast<const char*>(own), size))) {
      std::memcpy(to, text.data(), size);
      to += size;
    }
  }
  std::vector<std::string> show(const std::string& own) {
    table_.texts[static_cast<std::size_t>(rank_)] = own;
    table_.meeting.arrive_and_wait();
    std::vector<std::string> all = table_.texts;
    table_.meeting.arrive_and_wait();
    return all;
  }

  TeamTable& table_;
  int rank_;
};

/// Each member of a team does this, all at the same time; the first one on this thread.
inline void as_team(int size, const std::function<void(Ranks&)>& work) {
  TeamTable table(size);
  std::vector<std::jthread> others;
  for (int rank = 1; rank < size; ++rank)
    others.emplace_back([&table, &work, rank] {
      TeamMember member(table, rank);
      work(member);
    });
  TeamMember leader(table, 0);
  work(leader);
}

}  // namespace rabiline::test
