"""The proxy that tests of a server behind one stand on."""

import subprocess
from pathlib import Path

import pytest

from tests import install_proxy


@pytest.mark.promises
def test_nginx_is_here_and_speaks_tls() -> None:
    nginx = install_proxy.find_nginx()
    assert nginx is not None, install_proxy.HOW_TO_GET_NGINX
    said = subprocess.run([nginx, "-V"], capture_output=True, text=True, check=True).stderr
    assert "http_ssl_module" in said


def test_no_nginx_to_be_had_is_said_clearly(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(install_proxy, "find_nginx", lambda: None)
    monkeypatch.setattr(install_proxy, "_unpack", lambda: None)

    assert install_proxy.main() == 1
    assert "apt-get install nginx" in capsys.readouterr().err
