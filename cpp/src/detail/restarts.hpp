#pragma once

#include <utility>
#include <vector>

#include "detail/attempt.hpp"
#include "detail/verdicts.hpp"
#include "detail/workspace.hpp"

namespace pdoik::detail {

/// What is to be solved, one after the other.
class Requests {
 public:
  virtual ~Requests() = default;
  /// @returns Whether there is another. Both outlive its solve.
  virtual bool next(Request& request, Result*& result) = 0;
  /// What else there is to be said to one that has begun.
  virtual void prepare(Attempt&) {}
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
/// Searches for the goals alone run in lanes. A request has one lane while there are more requests,
/// and its later starts run beside the first ones when there are not. Starts count in their order
/// whatever lane came first: answers are the same one by one, in a batch, on any number of threads.
class Restarts {
 public:
  /// The workspace outlives it.
  explicit Restarts(Workspace& workspace);

  /// Solve all. Allocates nothing if results' q have their size.
  void run(Requests& requests);

 private:
  struct Lane {
    Attempt* attempt = nullptr;
    int start = 0;
  };

  /// Whether lanes know the goals, all of one kind.
  bool is_for_lanes(const Request& request) const;
  void begin(Attempt& attempt, const Request& request, Result& result);
  /// Give each idle lane a start of who has the fewest.
  void fill_lanes();
  Attempt* who_has_fewest_lanes();
  /// Let the lanes go on, and keep what those that end came to.
  void search_in_lanes();
  /// Where lanes cannot tell: balance is not kept by goals alone, and the paper's form is another.
  void search_in_turn(Attempt& attempt);
  /// Judge what is known of an attempt's starts, in their order.
  void advance(Attempt& attempt);
  void finish(Attempt& attempt);

  Workspace& workspace_;
  const Model& model_;
  bool in_lanes_;
  std::vector<Lane> lanes_;
  std::vector<Attempt> attempts_;
  Verdicts verdicts_;
  Eigen::VectorXd q_;
};

}  // namespace pdoik::detail
