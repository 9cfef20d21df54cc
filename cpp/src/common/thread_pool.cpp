#include "common/thread_pool.hpp"

#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <list>
#include <mutex>
#include <system_error>
#include <thread>

namespace pdoik::detail {
namespace {

/// Threads that wait for jobs. Never destroyed: a thread may still wait when the process ends.
class ThreadPool {
 public:
  static ThreadPool& shared() {
    // A child process has no threads but the one that made it, and begins with a pool of its own.
    static const int registered =
        pthread_atfork(nullptr, nullptr, [] { current() = new ThreadPool; });
    static_cast<void>(registered);
    return *current();
  }

  void run(int helpers, const std::function<void()>& work,
           const std::function<void()>& while_waiting) {
    Job job{&work, helpers, 0};
    std::unique_lock lock(mutex_);
    const auto place = jobs_.insert(jobs_.end(), &job);
    grow(helpers);
    lock.unlock();
    wake_.notify_all();
    work();
    lock.lock();
    jobs_.erase(place);  // nobody new begins
    const auto is_done = [&] { return job.running == 0; };
    while (!ended_.wait_for(lock, std::chrono::milliseconds(100), is_done)) {
      lock.unlock();
      while_waiting();
      lock.lock();
    }
  }

 private:
  struct Job {
    const std::function<void()>* work;
    int wanted, running;
  };

  static ThreadPool*& current() {
    static ThreadPool* pool = new ThreadPool;
    return pool;
  }

  void grow(int count) {
    try {
      for (; threads_ < std::min(count, kMostThreads); ++threads_)
        std::thread([this] { serve(); }).detach();
    } catch (const std::system_error&) {
      // The system gives no more threads: those there are do the work.
    }
  }

  [[noreturn]] void serve() {
    std::unique_lock lock(mutex_);
    while (true) {
      const auto wants = [](const Job* job) { return job->wanted > 0; };
      const auto place = std::find_if(jobs_.begin(), jobs_.end(), wants);
      if (place == jobs_.end()) {
        wake_.wait(lock);
        continue;
      }
      Job& job = **place;
      --job.wanted;
      ++job.running;
      lock.unlock();
      (*job.work)();
      lock.lock();
      --job.running;
      ended_.notify_all();
    }
  }

  static constexpr int kMostThreads = 256;

  std::mutex mutex_;
  std::condition_variable wake_, ended_;
  std::list<Job*> jobs_;
  int threads_ = 0;
};

}  // namespace

void run_together(int helpers, const std::function<void()>& work,
                  const std::function<void()>& while_waiting) {
  if (helpers > 0)
    ThreadPool::shared().run(helpers, work, while_waiting);
  else
    work();
}

int processor_count() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

}  // namespace pdoik::detail
