// The processes that share a training.
#include "training/group.h"

#include <c10/util/Exception.h>
#include <torch/cuda.h>
#include <torch/types.h>

#include "base/error.h"
#if defined(WETCURL_GLOO) || defined(WETCURL_NCCL)
#include <chrono>
#include <cstdlib>
#include <thread>
#include <torch/csrc/distributed/c10d/TCPStore.hpp>
#endif
#ifdef WETCURL_GLOO
#include <torch/csrc/distributed/c10d/ProcessGroupGloo.hpp>
#endif
#ifdef WETCURL_NCCL
#include <torch/csrc/distributed/c10d/ProcessGroupNCCL.hpp>
#endif

namespace wetcurl {

std::string device_of(const std::string& device, const Ranks& ranks) {
    if (device != "cuda" || ranks.alone()) return device;
    const long count = long(torch::cuda::device_count());
    if (ranks.here >= count)
        throw Error("device cuda: process " + std::to_string(ranks.here) + " of this host found " +
                    std::to_string(count) +
                    " CUDA devices, needed is one for each; --device cuda:0 where each sees its own alone");
    return "cuda:" + std::to_string(ranks.here);
}

bool can_share([[maybe_unused]] torch::Device device) {
#ifdef WETCURL_GLOO
    if (device.is_cpu()) return true;
#endif
#ifdef WETCURL_NCCL
    if (device.is_cuda()) return true;
#endif
    return false;
}

namespace {

std::string name_of(const Ranks& ranks) {
    return "train: rank " + std::to_string(ranks.mine) + " of " + std::to_string(ranks.of) + " (" +
           ranks.from + ")";
}

// Without the stack trace that LibTorch's errors carry.
std::string reason_of(const std::exception& e) {
    const auto* error = dynamic_cast<const c10::Error*>(&e);
    return error ? error->what_without_backtrace() : e.what();
}

#if defined(WETCURL_GLOO) || defined(WETCURL_NCCL)

using Store = c10::intrusive_ptr<c10d::Store>;

std::string variable(const char* name, const std::string& fallback) {
    const char* text = std::getenv(name);
    return text && *text ? text : fallback;
}

// Where the processes meet: a store of keys, which rank 0 serves.
class Meeting {
  public:
    explicit Meeting(const Ranks& ranks)
        : ranks_(ranks),
          host_(variable("MASTER_ADDR", "127.0.0.1")),
          port_(environment_number("MASTER_PORT", 29400, 1, 65535)),
          patience_(environment_number("WETCURL_RENDEZVOUS_SECONDS", 300, 1, 86400)) {}

    Store meet(const std::string& work) const {
        const auto end = Clock::now() + patience_;
        const Store store = open();
        store->set(key(ranks_.mine), std::vector<uint8_t>(work.begin(), work.end()));
        for (std::string missing; !(missing = missing_in(*store)).empty();) {
            if (Clock::now() > end)
                throw Error(where() + ": waited " + std::to_string(patience_.count()) + " s for rank" +
                            missing + ", which did not come");
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        require_same(*store);
        return store;
    }
    std::string where() const { return name_of(ranks_) + " at " + host_ + ":" + std::to_string(port_); }
    bool on_one_host() const { return host_ == "127.0.0.1" || host_ == "localhost"; }

  private:
    using Clock = std::chrono::steady_clock;

    Store open() const {
        c10d::TCPStoreOptions options;
        options.port = uint16_t(port_);
        // torchrun serves the store itself.
        options.isServer = ranks_.first() && variable("TORCHELASTIC_USE_AGENT_STORE", "") != "True";
        options.waitWorkers = false;
        options.timeout = patience_;
        try {
            return c10::make_intrusive<c10d::TCPStore>(host_, options);
        } catch (const std::exception& e) {
            throw Error(where() + ": " + reason_of(e) +
                        "; MASTER_ADDR names the host of rank 0, MASTER_PORT a port that is free there");
        }
    }
    static std::string key(long rank) { return "work of rank " + std::to_string(rank); }
    std::string missing_in(c10d::Store& store) const {
        std::string out;
        for (long r = 0; r < ranks_.of; ++r)
            if (!store.check({key(r)})) (out += " ") += std::to_string(r);
        return out;
    }
    // Everyone compares everyone: nobody goes on alone.
    void require_same(c10d::Store& store) const {
        const auto first = store.get(key(0));
        for (long r = 1; r < ranks_.of; ++r)
            if (const auto other = store.get(key(r)); other != first)
                throw Misuse(where() + ": rank " + std::to_string(r) + " would train\n" +
                             std::string(other.begin(), other.end()) + "\nrank 0\n" +
                             std::string(first.begin(), first.end()) + "\nall need the same");
    }

    Ranks ranks_;
    std::string host_;
    long port_;
    std::chrono::seconds patience_;
};

// Of either backend: they share no base that all versions of LibTorch know.
template <class Backend>
std::function<void(const Tensor&)> sum_by(const c10::intrusive_ptr<Backend>& backend) {
    return [backend](const Tensor& values) {
        std::vector<Tensor> list{values};
        backend->allreduce(list)->wait();
    };
}

#endif

#ifdef WETCURL_GLOO
auto make_gloo(const Store& store, const Ranks& ranks, bool on_one_host) {
    using Gloo = c10d::ProcessGroupGloo;
    const std::string interface = variable("GLOO_SOCKET_IFNAME", "");
    auto options = Gloo::Options::create();
    options->devices.push_back(on_one_host         ? Gloo::createDeviceForHostname("127.0.0.1")
                               : interface.empty() ? Gloo::createDefaultDevice()
                                                   : Gloo::createDeviceForInterface(interface));
    return c10::make_intrusive<Gloo>(store, int(ranks.mine), int(ranks.of), options);
}
#endif

#ifdef WETCURL_NCCL
auto make_nccl(const Store& store, const Ranks& ranks) {
    using Nccl = c10d::ProcessGroupNCCL;
    return c10::make_intrusive<Nccl>(store, int(ranks.mine), int(ranks.of), Nccl::Options::create());
}
#endif

}  // namespace

Group::Group(const Ranks& ranks, torch::Device device, [[maybe_unused]] const std::string& work)
    : ranks_(ranks), device_(device) {
    if (ranks.alone()) return;
    if (!can_share(device))
        throw Error(name_of(ranks) + ": this build shares no training on device " + device.str() +
                    "; the CPU needs Gloo (libgloo-dev) when it is built, CUDA devices NCCL (nccl.h)");
#if defined(WETCURL_GLOO) || defined(WETCURL_NCCL)
    const Meeting meeting(ranks);
    try {
        const Store store = meeting.meet(work);
#ifdef WETCURL_GLOO
        if (device.is_cpu()) sum_ = sum_by(make_gloo(store, ranks, meeting.on_one_host()));
#endif
#ifdef WETCURL_NCCL
        if (device.is_cuda()) {
            const auto backend = make_nccl(store, ranks);
            sum_ = sum_by(backend);
            // Not shutdown(): that waits for processes that are gone.
            close_ = [backend] { backend->abort(); };
        }
#endif
    } catch (const Error&) {
        throw;
    } catch (const std::exception& e) {
        throw Error(meeting.where() + ": lost the others: " + reason_of(e));
    }
    wait();
#endif
}

Group::~Group() {
    try {
        if (close_) close_();
    } catch (const std::exception&) {  // what ends the training has been said
    }
}

void Group::sum(const Tensor& values) const {
    if (!sum_) return;
    try {
        sum_(values);
    } catch (const std::exception& e) {
        throw Error(name_of(ranks_) + ": lost another one: " + reason_of(e));
    }
}

void Group::wait() const {
    const Tensor here = torch::ones({1}, device_);
    sum(here);
    here.item<float>();
}

}  // namespace wetcurl
