// Learned wet hair in a GPU's memory: hair_on_gpu SCENE.toml MODEL.h5. As hair.cpp, but kernels make the dry
// strands and measure the wet ones, and no strand is copied to or from the host.
#include <cmath>
#include <cstdio>
#include <string>
#include <wetcurl/wetcurl.hpp>

static void check(cudaError_t status) {
    if (status != cudaSuccess) throw std::runtime_error(std::string("CUDA: ") + cudaGetErrorString(status));
}

struct Free {
    void operator()(float* memory) const { cudaFree(memory); }
};
static std::unique_ptr<float, Free> floats_on_device(size_t count) {
    float* memory = nullptr;
    check(cudaMalloc(&memory, count * sizeof(float)));
    return std::unique_ptr<float, Free>(memory);
}

static wetcurl::PoseArray head_at(int frame) {
    const double angle = 0.02 * frame;
    return {0, 0, 0, std::cos(angle / 2), 0, std::sin(angle / 2), 0};
}

// About y, as head_at does; a thread for each point.
__global__ void turn(int frame, size_t points, const float* from, float* to) {
    const size_t k = size_t(blockIdx.x) * blockDim.x + threadIdx.x;
    if (k >= points) return;
    const float c = cosf(0.02f * float(frame)), s = sinf(0.02f * float(frame));
    const float* x = from + 3 * k;
    to[3 * k] = c * x[0] + s * x[2];
    to[3 * k + 1] = x[1];
    to[3 * k + 2] = -s * x[0] + c * x[2];
}

// How far each tip is from its root [m]; a thread for each strand.
__global__ void reach(size_t strands, size_t particles, const float* high, float* distance) {
    const size_t s = size_t(blockIdx.x) * blockDim.x + threadIdx.x;
    if (s >= strands) return;
    const float *root = high + 3 * particles * s, *tip = root + 3 * (particles - 1);
    distance[s] = norm3df(tip[0] - root[0], tip[1] - root[1], tip[2] - root[2]);
}

int main(int argc, char** argv) try {
    if (argc != 3) return std::fprintf(stderr, "use: hair_on_gpu SCENE.toml MODEL.h5\n"), 2;
    wetcurl::Hair hair(argv[1], argv[2], "cuda");
    const size_t n = size_t(hair.particles()), strands = size_t(hair.high_strands());
    const std::vector<float> at_rest = hair.low_at_rest();
    const size_t points = at_rest.size() / 3;
    const auto rest = floats_on_device(at_rest.size()), low = floats_on_device(at_rest.size()),
               high = floats_on_device(strands * n * 3), distance = floats_on_device(strands);
    check(cudaMemcpy(rest.get(), at_rest.data(), at_rest.size() * sizeof(float), cudaMemcpyHostToDevice));
    hair.bind(low.get(), high.get(), /*on_device=*/true);
    constexpr unsigned block = 128;
    const auto blocks = [](size_t threads) { return unsigned((threads + block - 1) / block); };
    for (int frame = 0; frame < 4; ++frame) {
        turn<<<blocks(points), block>>>(frame, points, rest.get(), low.get());
        check(cudaDeviceSynchronize());  // the strands are written before they are read
        if (frame == 0)
            hair.run(head_at(0));
        else
            hair.run(head_at(frame - 1), head_at(frame), head_at(frame + 1));
    }
    reach<<<blocks(strands), block>>>(strands, n, high.get(), distance.get());
    std::vector<float> distances(strands);
    check(cudaMemcpy(distances.data(), distance.get(), strands * sizeof(float), cudaMemcpyDeviceToHost));
    double sum = 0;
    for (const float d : distances) sum += d;
    std::printf("%zu strands, %.6f\n", strands, sum / double(strands));
} catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
}
