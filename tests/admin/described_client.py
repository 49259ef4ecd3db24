"""A client of the admin API made of its OpenAPI document alone: one method an operation, named by `operationId`.

Nothing here knows a route. Whatever comes back is held against the document: its status, headers, media type and, under the
document's own JSON Schema dialect (2020-12), its body, where a member that is not described is an error too."""

import copy
import http.client
import json
import urllib.parse

import jsonschema


def speaks_json(media_type):
    """One document, not one a line."""
    return "json" in media_type and "ndjson" not in media_type


class Misfit(AssertionError):
    """An answer that the document does not describe."""


class Answer:
    def __init__(self, status, headers, body):
        self.status, self.headers, self.body = status, headers, body

    @property
    def media_type(self):
        return self.headers.get("content-type", "").split(";")[0]

    def json(self):
        return json.loads(self.body)


def tightened(node):
    """The schemas with no room for members they do not name."""
    if isinstance(node, list):
        return [tightened(each) for each in node]
    if not isinstance(node, dict):
        return node
    made = {name: tightened(each) for name, each in node.items()}
    if "properties" in made and made.get("type") == "object":
        made.setdefault("additionalProperties", False)
    return made


class Operation:
    def __init__(self, client, path, method, said):
        self.client, self.path, self.method, self.said = client, path, method.upper(), said
        self.name = said["operationId"]
        self.parameters = [client.resolved(each) for each in said.get("parameters", [])]
        self.bodies = said.get("requestBody", {}).get("content", {})
        self.scope = said["security"][0]["key"][0] if said["security"] else None
        self.responses = {int(status): client.resolved(each) for status, each in said["responses"].items()}

    def target(self, values):
        """The path with its parameters, and the query; a parameter not given has its example or stays away."""
        path, query = self.path, {}
        for parameter in self.parameters:
            name = parameter["name"]
            if parameter["in"] == "path":
                path = path.replace("{" + name + "}", urllib.parse.quote(str(values[name]), safe=""))
            elif parameter["in"] == "query":
                value = values.get(name, parameter.get("example"))
                if value is not None:
                    query[name] = value
        return path + ("?" + urllib.parse.urlencode(query) if query else "")

    def example(self):
        """Media type and bytes of the body the document shows; none where it shows none."""
        for media_type, content in self.bodies.items():
            if "example" in content:
                return media_type, json.dumps(content["example"]).encode()
        return None, None

    def check(self, answer):
        at = f"{self.method} {self.path} {answer.status}"
        if answer.status not in self.responses:
            raise Misfit(f"{at}: not described: {answer.body[:300]}")
        described = self.responses[answer.status]
        for name in described.get("headers", {}):
            if name.lower() not in answer.headers:
                raise Misfit(f"{at}: header {name} is missing")
        if "content" not in described:
            if answer.body:
                raise Misfit(f"{at}: described without a body, came with {answer.body[:100]}")
            return
        if answer.media_type not in described["content"]:
            raise Misfit(f"{at}: {answer.media_type} is not described")
        if speaks_json(answer.media_type):
            try:
                self.client.validator(described["content"][answer.media_type]["schema"]).validate(answer.json())
            except jsonschema.ValidationError as misfit:
                raise Misfit(f"{at}: {misfit.json_path}: {misfit.message}") from None


class Client:
    """`source` is the local address to ask from; "" = whichever."""

    def __init__(self, url, document, key=None):
        self.document, self.key, self.source = document, key, ""
        self.address = urllib.parse.urlsplit(url).netloc
        self.tight = tightened({"components": document["components"]})
        self.operations = {}
        for path, item in document["paths"].items():
            for method, said in item.items():
                operation = Operation(self, path, method, said)
                self.operations[operation.name] = operation

    def resolved(self, node):
        while "$ref" in node:
            found = self.document
            for step in node["$ref"].removeprefix("#/").split("/"):
                found = found[step]
            node = found
        return node

    def validator(self, schema):
        whole = {**tightened(copy.deepcopy(schema)), **self.tight}
        jsonschema.Draft202012Validator.check_schema(whole)
        return jsonschema.Draft202012Validator(whole)

    def ask(self, name, values=None, body=None, media_type=None, headers=None, key="own", target=None):
        """Asks the operation `name` and checks the answer. `values` are path, query and header parameters by name; a body that is
        not given is the document's example; `key=None` asks without one."""
        operation = self.operations[name]
        values = values or {}
        if body is None and operation.bodies:
            media_type, body = operation.example()
        elif body is not None and not isinstance(body, bytes):
            media_type, body = media_type or next(iter(operation.bodies)), json.dumps(body).encode()
        sent = dict(headers or {})
        key = self.key if key == "own" else key
        if key:
            sent["authorization"] = f"Bearer {key}"
        if body is not None:
            sent["content-type"] = media_type or next(iter(operation.bodies), "application/octet-stream")
        for parameter in operation.parameters:
            if parameter["in"] == "header" and parameter["name"] in values:
                sent[parameter["name"]] = values[parameter["name"]]
        answer = self.send(operation.method, target or operation.target(values), body, sent)
        operation.check(answer)
        return answer

    def send(self, method, target, body, headers):
        connection = http.client.HTTPConnection(self.address, timeout=60, source_address=(self.source, 0))
        try:
            connection.request(method, target, body, headers)
            response = connection.getresponse()
            said = {name.lower(): value for name, value in response.getheaders()}
            # An event stream has no end: its first event says enough.
            body = response.readline() + response.readline() if said.get("content-type") == "text/event-stream" else response.read()
            return Answer(response.status, said, body)
        finally:
            connection.close()

    def __getattr__(self, name):
        if name not in self.__dict__.get("operations", {}):
            raise AttributeError(f"the document has no operation {name}")

        def call(values=None, **more):
            answer = self.ask(name, values, **more)
            if answer.status >= 400:
                raise Misfit(f"{name}: {answer.status}: {answer.body[:300]}")
            return answer.json() if speaks_json(answer.media_type) else answer.body
        return call
