# For a tap or homebrew-core; `packaging/recipes` enters version, address and checksum.
class Nlmodes < Formula
  desc "Nonlinear modes and responses of structures that meet stops"
  url "@ADDRESS@"
  version "@VERSION@"
  sha256 "@SHA256@"
  license "MIT"

  depends_on "rust" => :build

  def install
    system "cargo", "install", "--features", "full", *std_cargo_args(path: "crates/nlmodes-cli")
    bin.install_symlink "nlmodes-cli" => "nlmodes"
    generate_completions_from_executable(bin/"nlmodes-cli", "completions", shells: [:bash, :zsh, :fish])
    pkgshare.install "configs"
  end

  test do
    system bin/"nlmodes-cli", "new", "rod", "rod.toml"
    assert_match "nothing was computed", shell_output("#{bin}/nlmodes-cli check rod.toml")
    system bin/"nlmodes-cli", "run", "rod.toml", "--set", "method.harmonics=2", "--quiet"
    assert_path_exists testpath/"results/rod/branch.csv"
  end
end
