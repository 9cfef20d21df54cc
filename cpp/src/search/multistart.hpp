#pragma once

#include <chrono>
#include <utility>
#include <vector>

#include "search/acceptance.hpp"
#include "search/lane_schedule.hpp"
#include "search/solve_state.hpp"
#include "search/workspace.hpp"

namespace pdoik::detail {

/// What is to be solved, one after the other.
class Requests {
 public:
  virtual ~Requests() = default;
  /// @returns Whether there is another. Both outlive its solve.
  virtual bool next(Request& request, Result*& result) = 0;
  /// What else there is to be said to one that has begun.
  virtual void prepare(SolveState&) {}
};

/// One, and no other.
class OneRequest : public Requests {
 public:
  /// Both outlive it.
  OneRequest(const Request& request, Result& result) : request_(request), result_(&result) {}

  bool next(Request& request, Result*& result) override {
    request = request_;
    result = std::exchange(result_, nullptr);
    return result != nullptr;
  }

 private:
  const Request& request_;
  Result* result_;
};

/// The default method. From the first start, then from those of a low-discrepancy sequence, until
/// an answer is clear: the goals alone, which is cheap; then, if what that comes to touches
/// something, with what is near if that pays.
///
/// Searches for the goals alone run in lanes, those of several requests at once. Starts count in
/// their order whatever lane came first: answers are the same one by one, in a batch, on any number
/// of threads.
class Multistart {
 public:
  /// The workspace outlives it.
  explicit Multistart(Workspace& workspace);

  /// Solve all. Allocates nothing if results' q have their size.
  void run(Requests& requests);

 private:
  /// The request that comes next, if there is one.
  struct Next {
    Request request;
    Result* result = nullptr;
    bool exists = false;
  };

  /// Begin as many as there is room for.
  void begin_solves(Requests& requests, Next& next);
  /// Judge what is known of a solve's starts, in their order, and end it if one was the last.
  void conclude_ended(SolveState& solve);
  /// What a start has come to: an answer, or a candidate for the best that there is.
  /// @returns Whether the solve has ended.
  bool conclude(SolveState& solve, Trial& trial);
  /// Search from one start, where lanes cannot tell.
  void search_in_turn(SolveState& solve);
  void finish(SolveState& solve);

  Workspace& workspace_;
  LaneSchedule lanes_;
  std::vector<SolveState> solves_;
  Acceptance acceptance_;
};

}  // namespace pdoik::detail
