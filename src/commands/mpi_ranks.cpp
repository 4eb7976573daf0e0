#include "commands/mpi_ranks.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>

#include "commands/common.hpp"

#if RABILINE_MPI
#include <mpi.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <exception>
#include <limits>
#include <thread>
#endif

namespace rabiline {
namespace {

#if RABILINE_MPI
/// As MPI wants it: `to` += `from`, of 128 bits each.
void add_sums(void* from, void* to, int* count, MPI_Datatype* /*type*/) {
  for (std::ptrdiff_t i = 0; i < *count; ++i) {
    char* const place = static_cast<char*>(to) + i * static_cast<std::ptrdiff_t>(sizeof(Sum));
    Sum a = 0, b = 0;
    std::memcpy(&a, static_cast<const char*>(from) + i * static_cast<std::ptrdiff_t>(sizeof(Sum)), sizeof a);
    std::memcpy(&b, place, sizeof b);
    b += a;
    std::memcpy(place, &b, sizeof b);
  }
}

/// All calls come from the main thread. MPI itself waits busily; so all meet first, with naps in between.
class MpiRanks final : public Ranks {
 public:
  MpiRanks() {
    int given = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &given);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm here{};
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
    MPI_Comm_size(here, &neighbours_);
    MPI_Comm_free(&here);
    MPI_Type_contiguous(sizeof(Sum), MPI_BYTE, &sum_);
    MPI_Type_commit(&sum_);
    MPI_Op_create(add_sums, 1, &add_);
  }
  ~MpiRanks() override {
    if (std::uncaught_exceptions() > 0) MPI_Abort(MPI_COMM_WORLD, exit_code::mistake);
    MPI_Op_free(&add_);
    MPI_Type_free(&sum_);
    MPI_Finalize();
  }
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;

  int size() const override { return size_; }
  int rank() const override { return rank_; }
  int neighbours() const override { return neighbours_; }

  std::vector<std::string> collect(const std::string& own) override {
    const std::uint64_t length = own.size();
    std::vector<int> lengths, begins;
    std::uint64_t end = 0;
    for (const std::uint64_t one : exchange(length)) {
      begins.push_back(static_cast<int>(end));
      lengths.push_back(static_cast<int>(one));
      end += one;
      if (end > std::numeric_limits<int>::max()) throw std::length_error("too much for one message of MPI");
    }
    std::string all(leads() ? end : 0, '\0');
    MPI_Gatherv(own.data(), lengths[static_cast<std::size_t>(rank_)], MPI_CHAR, all.data(), lengths.data(),
                begins.data(), MPI_CHAR, 0, MPI_COMM_WORLD);
    std::vector<std::string> out;
    for (std::size_t i = 0; leads() && i < lengths.size(); ++i)
      out.push_back(all.substr(static_cast<std::size_t>(begins[i]), static_cast<std::size_t>(lengths[i])));
    return out;
  }

  void add_up(Sums& sums) override {
    constexpr std::size_t most = std::size_t{1} << 20;  // 16 MiB
    meet();
    for (std::size_t begin = 0; begin < sums.size(); begin += most) {
      Sum* const here = sums.data() + begin;
      const auto count = static_cast<int>(std::min(most, sums.size() - begin));
      MPI_Reduce(leads() ? MPI_IN_PLACE : here, leads() ? here : nullptr, count, sum_, add_, 0,
                 MPI_COMM_WORLD);
    }
  }

  [[noreturn]] void give_up(const std::string& why) override {
    std::array<char, 256> host{};
    ::gethostname(host.data(), host.size() - 1);
    say(stderr,
        "error: rank {} of {} on {} failed: {}\n  help: mend that, and start again: `rabiline run` goes on "
        "from its checkpoint\n",
        rank_, size_, host.data(), why);
    MPI_Abort(MPI_COMM_WORLD, exit_code::bad_input);
    std::_Exit(exit_code::bad_input);
  }

 private:
  void meet() {
    MPI_Request all{};
    MPI_Ibarrier(MPI_COMM_WORLD, &all);
    using namespace std::chrono_literals;
    for (auto nap = 20us;; nap = std::min(2 * nap, std::chrono::microseconds(2ms))) {
      int met = 0;
      MPI_Test(&all, &met, MPI_STATUS_IGNORE);
      if (met != 0) return;
      std::this_thread::sleep_for(nap);
    }
  }

  std::string broadcast_bytes(std::string of_leader) override {
    meet();
    std::uint64_t length = of_leader.size();
    MPI_Bcast(&length, sizeof length, MPI_BYTE, 0, MPI_COMM_WORLD);
    of_leader.resize(length);
    MPI_Bcast(of_leader.data(), static_cast<int>(length), MPI_CHAR, 0, MPI_COMM_WORLD);
    return of_leader;
  }

  void exchange_bytes(const void* own, std::size_t size, void* all) override {
    meet();
    MPI_Allgather(own, static_cast<int>(size), MPI_BYTE, all, static_cast<int>(size), MPI_BYTE,
                  MPI_COMM_WORLD);
  }

  int size_ = 1, rank_ = 0, neighbours_ = 1;
  MPI_Datatype sum_{};
  MPI_Op add_{};
};
#endif

/// What the launcher tells each process that it starts; 1 where there is none.
int processes_started() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"})
    if (const char* size = std::getenv(name)) return std::atoi(size);
  return 1;
}

int number_of_process() {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "SLURM_PROCID"})
    if (const char* number = std::getenv(name)) return std::atoi(number);
  return 0;
}

bool has_shard(const std::vector<std::string>& arguments) {
  return std::ranges::any_of(arguments, [](const std::string& a) { return a.starts_with("--shard"); });
}

bool fly_together(const std::vector<std::string>& arguments) {
  constexpr std::array<std::string_view, 4> verbs{"run", "resume", "merge", "reproduce"};
  return !arguments.empty() && std::ranges::find(verbs, arguments.front()) != verbs.end() &&
         !has_shard(arguments);
}

}  // namespace

bool is_left_to_the_first(const std::vector<std::string>& arguments) {
  return processes_started() > 1 && number_of_process() > 0 && !fly_together(arguments) &&
         !has_shard(arguments);
}

std::unique_ptr<Ranks> launched_ranks(const std::vector<std::string>& arguments) {
  const int started = processes_started();
  if (started <= 1 || !fly_together(arguments)) return nullptr;
#if RABILINE_MPI
  auto ranks = std::make_unique<MpiRanks>();
  if (ranks->size() == started) return ranks;
  const std::string why = fmt::format("MPI joins {} of them", ranks->size());
  ranks.reset();
  const std::string help = "start them with `mpirun`, or `srun --mpi=pmix`";
#else
  const std::string why = "this rabiline was built without MPI";
  const std::string help = "install libopenmpi-dev and build it again";
#endif
  throw ArgumentError(fmt::format(
      "{} processes were started, and each of them would fly all of it, as {}\n  help: {}; or give "
      "each its own shard, --shard NUMBER/{} and another OUT.h5, and join them with `rabiline merge`",
      started, why, help, started));
}

}  // namespace rabiline
